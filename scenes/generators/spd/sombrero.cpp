#include <array>
#include <cmath>

#include "scenes/base/portable_math.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

SceneData make_sombrero(int size) {
  SpdScene scene(
      {.from = {0, 5, -8}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 40, .width = 512, .height = 512},
      {{10, 10, -10}});
  scene.fill({{1, 0.1f, 0.1f}, 0.8f, 0, 2.60078f, 0, 1});

  // SPD takes the heights at `points` places that begin at -4 and end a step before 4, and then stretches
  // them to 4.
  const int points = 16 << size;
  for (int row = 0; row < points; ++row)
    for (int column = 0; column < points; ++column) {
      const double x = 8.0 * column / points - 4, z = 8.0 * row / points - 4, r = std::sqrt(x * x + z * z);
      const auto height = static_cast<float>(sine_cosine_of_turns(r).cosine * exponential(-r));
      scene.vertex({8.0 * column / (points - 1) - 4, double(height) - 3, 8.0 * row / (points - 1) - 4});
    }
  const auto step = static_cast<std::uint32_t>(points);
  for (std::uint32_t row = 0; row + 1 < step; ++row)
    for (std::uint32_t column = 0; column + 1 < step; ++column) {
      const std::uint32_t corner = row * step + column, next = corner + step;
      scene.polygon(std::array{corner, next + 1, corner + 1});
      scene.polygon(std::array{corner, next, next + 1});
    }
  return scene.take();
}

}  // namespace

SceneGenerator spd_sombrero_generator() {
  return spd_generator({"sombrero", "a height field: the waves around a drop (A. Enzmann)",
                        "doublings of the grid: 2 (16 * 2^size - 1)^2 triangles", 2, 8, make_sombrero});
}

}  // namespace raymeter
