#pragma once
#include "accel/registry.h"

namespace raymeter {

/// `brute-force`: every primitive, every ray, by definition the truth. A closest-hit query tests all
/// primitives; an any-hit query tests them in order until one is hit. It takes no steps and no memory.
StructureKind brute_force_kind();

}  // namespace raymeter
