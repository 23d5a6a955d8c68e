#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `octree`: Glassner, "Space Subdivision for Fast Ray Tracing", IEEE CG&A 4(10), 1984; with
/// `traversal=top-down` the same leaves, walked as by Revelles, Urena and Lastra, 2000.
/// Counters: an inner node visited is a step, a leaf visited is a cell step; a point location is a
/// descent from the root (glassner only, one for each leaf).
StructureKind octree_kind();

}  // namespace raymeter
