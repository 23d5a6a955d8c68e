#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/base/random.h"
#include "scenes/generators/families.h"

namespace raymeter {
namespace {

constexpr double height = 0.3;              // of the whole terrain, whose sides are 1
constexpr std::uint32_t first_lattice = 3;  // hills along a side in the coarsest layer

/// Perlin's gradient noise ("Improving Noise", 2002) in two dimensions over a square of `cells` lattice cells
/// to a side, with gradients from `random`.
class GradientNoise {
 public:
  GradientNoise(std::uint32_t cells, Random& random) : stride_(cells + 1) {
    for (std::uint64_t i = 0; i < std::uint64_t{stride_} * stride_; ++i) {
      const float x = random.uniform(-1, 1);
      gradients_.push_back({x, random.uniform(-1, 1)});
    }
  }

  /// At a point inside the square 0 .. cells.
  double at(double x, double y) const {
    const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
    const double u = x - column, v = y - row;
    const double low = mix(slope(column, row, u, v), slope(column + 1, row, u - 1, v), fade(u));
    const double high =
        mix(slope(column, row + 1, u, v - 1), slope(column + 1, row + 1, u - 1, v - 1), fade(u));
    return mix(low, high, fade(v));
  }

 private:
  struct Gradient {
    float x, y;
  };
  static double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
  static double mix(double a, double b, double t) { return a + t * (b - a); }
  double slope(std::uint32_t column, std::uint32_t row, double u, double v) const {
    const Gradient& g = gradients_[std::size_t{row} * stride_ + column];
    return g.x * u + g.y * v;
  }

  std::uint32_t stride_;
  std::vector<Gradient> gradients_;
};

/// Heights at the (n + 1)^2 points of a square grid: layers of noise, each twice as fine as the one before
/// and `roughness` times as high, down to hills of two grid cells (fractional Brownian motion; Musgrave,
/// Kolb, Mace, "The synthesis and rendering of eroded fractal terrains", 1989). Scaled to 0 .. `height`.
std::vector<double> fractal_heights(std::uint32_t n, double roughness, Random& random) {
  std::vector<double> heights(std::size_t{n + 1} * (n + 1));
  double amplitude = 1;
  for (std::uint32_t cells = first_lattice; cells == first_lattice || 2 * cells <= n; cells *= 2) {
    // Shifted by a part of a cell, or all layers would be 0 at the coarsest layer's lattice points.
    const double shift_x = random.uniform(), shift_y = random.uniform();
    const GradientNoise noise(cells + 1, random);
    for (std::uint32_t row = 0; row <= n; ++row)
      for (std::uint32_t column = 0; column <= n; ++column)
        heights[std::size_t{row} * (n + 1) + column] +=
            amplitude * noise.at(double(column) * cells / n + shift_x, double(row) * cells / n + shift_y);
    amplitude *= roughness;
  }
  const auto [lowest, highest] = std::ranges::minmax(heights);
  const double range = highest - lowest;
  for (double& z : heights) z = range > 0 ? (z - lowest) / range * height : 0;
  return heights;
}

SceneData make_terrain(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const double squares = std::sqrt(0.5 * arguments.number("triangles"));
  const auto n = static_cast<std::uint32_t>(std::max(1.0, std::floor(squares + 0.5)));
  const auto heights = fractal_heights(n, arguments.number("roughness"), random);

  SceneData data;
  for (std::uint32_t row = 0; row <= n; ++row)
    for (std::uint32_t column = 0; column <= n; ++column)
      data.vertices.push_back({static_cast<float>(double(column) / n), static_cast<float>(double(row) / n),
                               static_cast<float>(heights[data.vertices.size()])});
  for (std::uint32_t row = 0; row < n; ++row)
    for (std::uint32_t column = 0; column < n; ++column) {
      const std::uint32_t corner = row * (n + 1) + column, above = corner + n + 1;
      data.triangles.push_back({corner, corner + 1, above + 1});
      data.triangles.push_back({corner, above + 1, above});
    }
  data.materials = {{.colour = {0.62f, 0.55f, 0.42f}, .specular = 0}};
  // From above the southern edge, with a low sun in the west so that the hills cast shadows.
  data.camera = Camera{.from = {0.42f, -0.3f, 0.9f}, .at = {0.5f, 0.42f, 0.1f}, .up = {0, 0, 1}, .angle = 38};
  data.lights = {{{-2.0f, 0.9f, 2.2f}, {1, 1, 1}}};
  return data;
}

}  // namespace

SceneGenerator terrain_generator() {
  return {"terrain",
          "a fractal height field: one surface, finely divided",
          {{"triangles", ParameterType::integer, "60000",
            "about how many: the nearest 2 n^2, two for each square of an n x n grid", 2, 1e8},
           {"roughness", ParameterType::number, "0.5",
            "height of each layer of hills over that of the layer twice as coarse", 0, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          make_terrain};
}

}  // namespace raymeter
