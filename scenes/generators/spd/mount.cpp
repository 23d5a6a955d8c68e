#include <array>
#include <cmath>

#include "scenes/base/portable_math.h"
#include "scenes/generators/spd/rotation.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

/// SPD's seed for a point of the lattice of 2^size squares a side. Its flaw, that it repeats itself, is part
/// of the published mountain.
std::int64_t seed_at(std::int64_t x, std::int64_t y, int size) {
  constexpr std::int64_t mountain = 21;
  const std::int64_t low = size <= 7 ? x << (7 - size) : 0;
  return mountain + (((x << (23 - size)) + (y << (15 - size)) + low) & 0xffff);
}

/// A normally distributed number (polar method of Marsaglia) from the linear congruential generator 8121 x +
/// 28411 mod 134456 (Press et al., "Numerical Recipes", 1986).
double gaussian(std::int64_t seed) {
  constexpr std::int64_t modulus = 134456;
  const auto next = [&seed] { return seed = (28411 + seed * 8121) % modulus; };
  double x, square;
  do {
    x = static_cast<double>(next()) * 2 / modulus - 1;
    const double y = static_cast<double>(next()) * 2 / modulus - 1;
    square = x * x + y * y;
  } while (square >= 1);
  return x * std::sqrt(-2 * natural_log(square) / square);
}

/// The square [-1, 1]^2 with heights by midpoint displacement (Carpenter's method, extended to squares), each
/// point displaced by a number that depends on its place alone.
class Mountain {
 public:
  explicit Mountain(int size) : size_(size), squares_(1 << size), heights_(points() * points()) {
    for (int width = squares_; width > 1; width /= 2)
      for (int y = 0; y < squares_; y += width)
        for (int x = 0; x < squares_; x += width) divide(x, y, width);
  }

  void add_to(SpdScene& scene) {
    const double spacing = 2.0 / squares_;
    for (int y = 0; y <= squares_; ++y)
      for (int x = 0; x <= squares_; ++x) scene.vertex({x * spacing - 1, y * spacing - 1, height(x, y)});
    add_squares(scene, 0, 0, squares_);
  }

 private:
  std::size_t points() const { return static_cast<std::size_t>(squares_) + 1; }
  std::uint32_t index(int x, int y) const {
    return static_cast<std::uint32_t>(static_cast<std::size_t>(y) * points() + static_cast<std::size_t>(x));
  }
  double& height(int x, int y) { return heights_[index(x, y)]; }

  /// Sets the middle of a square and those of its edges; an edge's is the same from both sides.
  void divide(int x, int y, int width) {
    const int half = width / 2, right = x + width, top = y + width;
    // For a fractal dimension of 2.2: sqrt(r^2 - 1), r = 2 / 2^(1 / 1.2).
    static const double roughness = std::sqrt(exponential(natural_log(2) / 3) - 1);
    const double rise = half * 2.0 / squares_ * roughness;
    const auto edge = [&](int x0, int y0, int x1, int y1) {
      const int middle_x = (x0 + x1) / 2, middle_y = (y0 + y1) / 2;
      height(middle_x, middle_y) =
          (height(x0, y0) + height(x1, y1)) / 2 + rise * gaussian(seed_at(middle_x, middle_y, size_));
    };
    edge(x, y, right, y);
    edge(right, y, right, top);
    edge(x, top, right, top);
    edge(x, y, x, top);
    height(x + half, y + half) = (height(x, y) + height(right, y) + height(right, top) + height(x, top)) / 4 +
                                 1.4142136 * rise * gaussian(seed_at(x + half, y + half, size_));
  }

  /// In the order of the recursion.
  void add_squares(SpdScene& scene, int x, int y, int width) {
    if (width == 1) {
      const std::uint32_t corner[] = {index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)};
      scene.polygon(std::array{corner[0], corner[1], corner[2]});
      scene.polygon(std::array{corner[2], corner[3], corner[0]});
      return;
    }
    const int half = width / 2;
    add_squares(scene, x, y, half);
    add_squares(scene, x + half, y, half);
    add_squares(scene, x + half, y + half, half);
    add_squares(scene, x, y + half, half);
  }

  int size_, squares_;
  std::vector<double> heights_;
};

/// A pyramid: four spheres around a centre, one above it.
void add_spheres(SpdScene& scene, const Vec3d& centre, double radius) {
  const Vec3d top{0, 0, radius * std::sqrt(1.5)};
  scene.sphere(centre + top, radius);
  const double half = 1 / std::sqrt(2.0);
  const Vec3d side = Rotation::about({half, half, 0}, {std::sqrt(8.0) / 3, -1.0 / 3})(top);
  for (int third = 0; third < 3; ++third)
    scene.sphere(centre + Rotation::about_z(sine_cosine_of_turns(third / 3.0))(side), radius);
}

SceneData make_mount(int size) {
  SpdScene scene({.from = {-1.6f, 1.6f, 1.7f},
                  .at = {0, 0, 0},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{-100, -100, 100}});
  scene.fill({{1, 1, 1}, 0.1f, 0.1f, 101.148f, 0.9f, 1.5f});
  add_spheres(scene, {-0.8, 0.8, 1}, 0.17);
  scene.fill(spd_matte({0.5f, 0.45f, 0.35f}));
  Mountain(size).add_to(scene);
  return scene.take();
}

}  // namespace

SceneGenerator spd_mount_generator() {
  return spd_generator({"mount", "a fractal mountain and four spheres of glass",
                        "how often the ground is quartered: 2 * 4^size triangles, 4 spheres", 6, 12,
                        make_mount});
}

}  // namespace raymeter
