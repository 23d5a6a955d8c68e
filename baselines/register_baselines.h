#pragma once
#include "accel/registry.h"

namespace raymeter {

/// embree, counted-bvh, brute-force.
void register_baselines(Registry& registry);

}  // namespace raymeter
