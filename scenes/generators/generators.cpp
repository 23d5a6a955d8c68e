#include "scenes/generators/generators.h"

#include "scenes/generators/families.h"

namespace raymeter {

std::span<const SceneGenerator> scene_generators() {
  static const std::vector<SceneGenerator> generators{
      soup_generator(),  terrain_generator(), clusters_generator(), crowding_generator(),
      sizes_generator(), slivers_generator(), stadium_generator(),  two_scales_generator(),
  };
  return generators;
}

}  // namespace raymeter
