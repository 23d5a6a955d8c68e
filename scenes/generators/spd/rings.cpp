#include <array>
#include <cmath>

#include "scenes/generators/spd/rotation.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

constexpr double ring_radius = 0.07412;  ///< at which the rings touch each other

/// The corners of six pentagons that lie in the planes through a dodecahedron's centre and join the middles
/// of its edges; the whole fits into the unit sphere.
std::array<Vec3d, 30> ring_corners() {
  std::array<Vec3d, 30> corners;
  const double scale = 1 / (1 + ring_radius);
  for (int i = 0; i < 5; ++i) {
    const auto [sine, cosine] = sine_cosine_of_turns(i / 5.0);
    corners[static_cast<std::size_t>(i)] = {scale * cosine, scale * sine, 0};
  }
  // The angle between two faces is 2 acos(cos 60 / sin 36 degrees).
  const double half = 0.5 / sine_cosine_of_turns(0.1).sine;
  const Rotation tilt = Rotation::about_x({2 * half * std::sqrt(1 - half * half), 2 * half * half - 1});
  for (std::size_t ring = 1; ring < 6; ++ring) {
    const Rotation turn = Rotation::about_z(sine_cosine_of_turns(static_cast<double>(2 * ring - 1) / 10));
    for (std::size_t i = 0; i < 5; ++i) corners[5 * ring + i] = turn(tilt(corners[i]));
  }
  return corners;
}

void add_rings(SpdScene& scene, const std::array<Vec3d, 30>& corners, const Vec3d& centre) {
  constexpr Vec3 colours[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
  for (std::size_t ring = 0; ring < 6; ++ring) {
    scene.fill({colours[ring], 0.5f, 0.2f, 3.0827f, 0, 0});
    for (std::size_t i = 0; i < 5; ++i) {
      const Vec3d corner = centre + corners[5 * ring + i];
      scene.cylinder(corner, centre + corners[5 * ring + (i + 4) % 5], ring_radius);
      scene.sphere(corner, ring_radius);
    }
  }
}

SceneData make_rings(int size) {
  // The pyramid just fills the view of 45 degrees from its top.
  const double distance = 1 / sine_cosine_of_turns(1.0 / 16).sine, tangent = std::sqrt(2.0) - 1;
  const auto eye = static_cast<float>(-distance);
  SpdScene scene({.from = {-1, eye, 0.5f},
                  .at = {-1, static_cast<float>(1 - distance), 0.5f},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{3, eye, 3}, {-4, eye, 1}, {2, eye, -4}});
  scene.fill(spd_matte({1, 1, 1}));
  const double wall = distance * (size + 1), half = 1.01 * (wall + distance) * tangent;
  scene.polygon({{half - 1, wall, half + 0.5},
                 {-half - 1, wall, half + 0.5},
                 {-half - 1, wall, -half + 0.5},
                 {half - 1, wall, -half + 0.5}});
  const std::array<Vec3d, 30> corners = ring_corners();
  for (int layer = 0; layer < size; ++layer)
    for (int z = 0; z <= layer; ++z)
      for (int x = 0; x <= layer; ++x)
        add_rings(scene, corners, {2.0 * x - layer, distance * (layer + 1), 2.0 * z - layer});
  return scene.take();
}

}  // namespace

SceneGenerator spd_rings_generator() {
  return spd_generator({"rings", "a pyramid of balls of six interlocking rings before a wall",
                        "layers: 5 size (size+1) (2 size+1) spheres and as many cylinders, one square", 7,
                        135, make_rings});
}

}  // namespace raymeter
