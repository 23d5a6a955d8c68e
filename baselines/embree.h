#pragma once
#include <string>

#include "accel/registry.h"

namespace raymeter {

/// `embree`: Embree's own BVH and its own traversal (Wald et al., "Embree: A Kernel Framework for Efficient
/// CPU Ray Tracing", 2014). Triangles are Embree's, in the Scene's own buffers; quadrics are user geometry
/// with our filter and our `decide`, so that both sides of a comparison pay for the same kernels.
///
/// What is inside the timed region: with `rays=converted`, filling Embree's ray from ours, for each ray;
/// with `rays=in-place`, `prepare` has laid out the batch as Embree wants it, and only what the previous
/// trace overwrote (tfar, and geomID of closest hits) is written again. Reading the answers into ours is
/// always inside.
///
/// Its answers differ from the truth where its kernels do, and where its interval does: it accepts t = tnear,
/// which ours does not (graded at_limit). Rays it must not be given are sorted out in `prepare`: those that
/// by definition hit nothing (not traceable, or an empty interval) are answered as misses, those that ask for
/// t <= 0 or have coordinates beyond `embree_largest_coordinate` as `not_answered` (scenes/geometry/ray.h).
///
/// stats().bytes is what Embree allocates for its BVH; the Scene's buffers are no part of it. A build
/// includes making the device, 0.1 ms, and the first one in a process also starts Embree, 1 ms (or the first
/// build of counted-bvh does, with which a comparison begins).
StructureKind embree_kind();

/// Of the Embree that is loaded, which need not be the one whose headers were compiled: "3.13.5", or
/// "unknown" where it gives no device. Starts Embree.
std::string embree_version();

}  // namespace raymeter
