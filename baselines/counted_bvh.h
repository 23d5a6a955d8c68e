#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `counted-bvh`: a BVH made by Embree's builder (rtcBuildBVH, binned SAH, no spatial splits), walked and
/// counted by us, because Embree can't be counted in: what a BVH like Embree's costs in steps and tests.
///
/// A step is a node whose box the ray enters before its best hit; a cell step is a leaf. `branching` boxes
/// are tested at each inner step. Nodes are visited front to back.
StructureKind counted_bvh_kind();

}  // namespace raymeter
