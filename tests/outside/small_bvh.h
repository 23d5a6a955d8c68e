#pragma once
#include "accel/registry.h"

/// Registers `small-bvh`: a binary BVH built by binned SAH (Wald, "On fast Construction of SAH-based Bounding
/// Volume Hierarchies", 2007), with a float kernel of its own for triangles (Moeller and Trumbore 1997).
void register_small_bvh(raymeter::Registry& registry);
