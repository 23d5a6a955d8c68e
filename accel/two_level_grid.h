#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `two-level-grid`: a uniform grid whose crowded cells hold a grid of their own (Jevans & Wyvill, "Adaptive
/// Voxel Subdivision for Ray Tracing", 1989), to depth 2.
StructureKind two_level_grid_kind();

}  // namespace raymeter
