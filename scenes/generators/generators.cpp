#include "scenes/generators/generators.h"

#include <utility>

#include "scenes/generators/families.h"

namespace raymeter {

std::span<const SceneGenerator> scene_generators() {
  static const std::vector<SceneGenerator> generators = [] {
    std::vector<SceneGenerator> all{
        soup_generator(),       terrain_generator(),     clusters_generator(),
        crowding_generator(),   sizes_generator(),       slivers_generator(),
        stadium_generator(),    two_scales_generator(),  paper_still_life_generator(),
        paper_hall_generator(), paper_chess_generator(),
    };
    for (SceneGenerator& family : spd_generators()) all.push_back(std::move(family));
    return all;
  }();
  return generators;
}

}  // namespace raymeter
