#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `counted-bvh`: a BVH made by Embree's builder (rtcBuildBVH, binned SAH, no spatial splits), walked and
/// counted by us, because Embree can't be counted in: what a BVH like Embree's costs in steps and tests.
///
/// A step is a node whose box the ray enters before its best hit; a cell step is a leaf. Nodes are visited
/// front to back. Up to `branching` boxes are tested at each inner step, so that steps compare only between
/// equal `branching`; the default is the width of Embree's own BVH. The builder's default costs hold a test
/// as dear as a box; leaves have at most 8 primitives, where Embree's own hold blocks of 4.
StructureKind counted_bvh_kind();

}  // namespace raymeter
