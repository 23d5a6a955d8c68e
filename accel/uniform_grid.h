#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `grid`: the heuristic grid of Sakai, Watanabe, Miyoshi, Fukuda ("A Method for Accelerating Ray Tracing by
/// Optimizing Regular Spatial Subdivision", early 1990s). Cells as large as the mean bounding box, primitives
/// registered by bounding box, no mailbox. With `leaf=simd` its leaves are those of leaf_grid.h.
StructureKind grid_kind();

/// `tunable-grid`: the same class with every knob free.
StructureKind tunable_grid_kind();

}  // namespace raymeter
