#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/base/portable_math.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

constexpr int teeth = 36, corners = 4 * teeth;
constexpr double rim = 0.1;  ///< what the teeth take up of the radius

/// The outline's corners, counterclockwise: two on top of each tooth and two at the bottom beside it.
std::array<Vec3d, corners> outline(const Vec3d& centre, double first_tooth, double outer, double inner) {
  std::array<Vec3d, corners> points;
  for (int i = 0; i < corners; ++i) {
    constexpr double place[] = {-0.19, 0.19, 0.3, 0.7};  // in teeth from the tooth's middle
    const int tooth = i / 4;
    const auto [sine, cosine] = sine_cosine_of_turns(first_tooth + (tooth + place[i % 4]) / teeth);
    const double radius = i % 4 < 2 ? outer : inner;
    points[static_cast<std::size_t>(i)] = centre + Vec3d{radius * cosine, radius * sine, 0};
  }
  return points;
}

/// `first_tooth` in turns; `centre` that of the upper face.
void add_gear(SpdScene& scene, const Vec3d& centre, double first_tooth, double outer, double inner,
              double thickness) {
  std::array<std::uint32_t, corners> top, bottom, under;
  std::size_t i = 0;
  for (const Vec3d& point : outline(centre, first_tooth, outer, inner)) {
    top[i] = scene.vertex(point);
    bottom[i++] = scene.vertex(point - Vec3d{0, 0, thickness});
  }
  scene.polygon(top);
  for (i = 0; i < corners; ++i) {
    const std::size_t next = (i + 1) % corners;
    scene.polygon(std::array{top[i], bottom[i], bottom[next], top[next]});
  }
  // Seen from below: the other way round, from the second corner on.
  for (i = 0; i < corners; ++i) under[i] = bottom[(corners + 1 - i) % corners];
  scene.polygon(under);
}

/// One of seven steps, from 0.01 to 0.87, exactly as SPD rounds them.
double step(int number, double sevenths) {
  const double x = number * sevenths / 7;
  return 0.01 + (x - std::floor(x));
}

Material gear_fill(int x, int y, int z) {
  const Vec3d colour{step(x * 3 + y * 2 + z + 1, 5), step(y * 3 + z * 2 + x + 1, 3),
                     step(z * 3 + x * 2 + y + 1, 2)};
  const Vec3 brightest = to_float((1 / std::max({colour.x, colour.y, colour.z})) * colour);
  if ((x * 4 + y * 2 + z) % 5 == 0) return {brightest, 0.2f, 0, spd_no_highlight, 0.8f, 1.1f};
  return spd_matte(brightest);
}

SceneData make_gears(int size) {
  SpdScene scene({.from = {-1.1f, -2.1f, 2.6f},
                  .at = {0, 0, 0},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{2, 4, 4}, {-2, 4, 3}, {2, -2.5f, 2.5f}, {-1, -4, 2}, {-1.111f, -2.121f, 2.626f}});
  scene.fill({{1, 0.85f, 0.7f}, 0.3f, 0.6f, 3.0827f, 0, 0});
  scene.polygon({{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}});

  // The gears mesh, so that `size` of them and their overlaps span [-1, 1]; layers fill the height from 1 to
  // 0.
  const double radius = 1 / (size - (size - 1) * rim / 2), distance = radius * (2 - rim);
  const double thickness = std::min(0.1, 1 / (2.0 * size));
  for (int z = 0; z < size; ++z)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        scene.fill(gear_fill(x, y, z));
        // Neighbours are turned by half a tooth; a gap keeps them from touching.
        add_gear(scene, {radius - 1 + x * distance, radius - 1 + y * distance, 1 - double(z) / size},
                 (x + y + z) % 2 * 0.5 / teeth, 0.995 * radius, (1 - rim) * radius, thickness);
      }
  return scene.take();
}

}  // namespace

SceneGenerator spd_gears_generator() {
  return spd_generator({"gears", "a block of meshing gears, some of glass, over a mirroring floor",
                        "along each side: size^3 gears of 144 rectangles and two faces of 144 corners", 4, 44,
                        make_gears});
}

}  // namespace raymeter
