#include <array>
#include <cmath>

#include "scenes/generators/spd/rotation.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

constexpr double shrinkage = 1.0 / 3;

/// Where the nine children touch a ball whose parent is below: three triples of a close packing, turned so
/// that one triple sits on top of the other.
std::array<Vec3d, 9> places_of_children() {
  const double half = 1 / std::sqrt(2.0);
  const Rotation tilt = Rotation::about({half, -half, 0}, {std::sqrt(2.0 / 3), std::sqrt(1.0 / 3)});
  std::array<Vec3d, 9> places;
  for (int third = 0; third < 3; ++third) {
    const Rotation turn = Rotation::about_z(sine_cosine_of_turns(third / 3.0));
    const std::size_t first = 3 * static_cast<std::size_t>(third);
    places[first] = turn(tilt({half, half, 0}));
    places[first + 1] = turn(tilt({half, 0, -half}));
    places[first + 2] = turn(tilt({0, half, -half}));
  }
  return places;
}

/// Turns the z axis to a direction. Directions this close to the axis are taken for it, as in SPD: the
/// roundings of the recursion must not turn a ball about itself.
Rotation from_z_to(const Vec3d& direction) {
  constexpr double close = 0.9999;
  if (direction.z >= close) return Rotation();
  if (direction.z <= -close) return Rotation::about_y({0, -1});
  const Vec3d axis = normalized(Vec3d{-direction.y, direction.x, 0});
  return Rotation::about(axis, {std::sqrt(1 - direction.z * direction.z), direction.z});
}

class Flake {
 public:
  explicit Flake(SpdScene& scene) : scene_(scene) {}

  void grow(int depth, const Vec3d& centre, double radius, const Vec3d& direction) {
    scene_.sphere(centre, radius);
    if (depth == 0) return;
    const Rotation rotation = from_z_to(direction);
    for (const Vec3d& place : places_) {
      const Vec3d outward = rotation(place);
      grow(depth - 1, centre + (radius * (1 + shrinkage)) * outward, radius * shrinkage, outward);
    }
  }

 private:
  SpdScene& scene_;
  const std::array<Vec3d, 9> places_ = places_of_children();
};

SceneData make_balls(int size) {
  SpdScene scene({.from = {2.1f, 1.3f, 1.7f},
                  .at = {0, 0, 0},
                  .up = {0, 0, 1},
                  .angle = 45,
                  .width = 512,
                  .height = 512},
                 {{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}});
  scene.fill({{1, 0.75f, 0.33f}, 0.8f, 0, spd_no_highlight, 0, 1});
  scene.polygon({{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}});
  scene.fill({{1, 0.9f, 0.7f}, 0.5f, 0.5f, 3.0827f, 0, 1});
  Flake(scene).grow(size, {0, 0, 0}, 0.5, {0, 0, 1});
  return scene.take();
}

}  // namespace

SceneGenerator spd_balls_generator() {
  return spd_generator(
      {"balls", "a snowflake of mirroring spheres, nine on each, over a floor (Haines' sphereflake)",
       "depth of the recursion: (9^(size+1) - 1) / 8 spheres, one square", 4, 8, make_balls});
}

}  // namespace raymeter
