#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `brick-grid`: a coarse uniform grid whose occupied cells hold trees of 4x4x4 bricks, walked and tested
/// with SIMD instructions (bricks.h). Every hit is still decided exactly.
StructureKind brick_grid_kind();

}  // namespace raymeter
