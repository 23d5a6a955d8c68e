#include "accel/brick_grid.h"
#include "accel/octree.h"
#include "accel/registry.h"
#include "accel/two_level_grid.h"
#include "accel/uniform_grid.h"

namespace raymeter {

void register_accel(Registry& registry) {
  registry.add(grid_kind());
  registry.add(tunable_grid_kind());
  registry.add(octree_kind());
  registry.add(two_level_grid_kind());
  registry.add(brick_grid_kind());
}

}  // namespace raymeter
