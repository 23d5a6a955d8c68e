#include "scenes/generators/spd/rotation.h"
#include "scenes/generators/spd/spd.h"

namespace raymeter {
namespace {

void add_jacks(SpdScene& scene, int depth, const Vec3d& centre, double scale, const Rotation& rotation) {
  constexpr double arm = 0.75, thickness = 0.075, knob = 0.15;
  const Vec3d axes[] = {rotation({1, 0, 0}), rotation({0, 1, 0}), rotation({0, 0, 1})};
  for (const Vec3d& axis : axes)
    scene.cylinder(centre - (arm * scale) * axis, centre + (arm * scale) * axis, thickness * scale);
  for (const double side : {arm, -arm})
    for (const Vec3d& axis : axes) scene.sphere(centre + (side * scale) * axis, knob * scale);
  if (depth == 1) return;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5})
        add_jacks(scene, depth - 1, centre + scale * rotation({x, y, z}), 0.5 * scale, rotation);
}

SceneData make_jacks(int size) {
  SpdScene scene(
      {.from = {0, 0, -8}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle = 25, .width = 256, .height = 256},
      {{-10, 3, -20}}, {0.2f, 0.05f, 0.2f});
  scene.fill({{0.737f, 0.561f, 0.561f}, 0.7f, 0.7f, 11.1434f, 0, 1});
  add_jacks(scene, size, {0, 0, 0}, 1,
            Rotation::about_x(sine_cosine_of_turns(-30.0 / 360)) *
                Rotation::about_y(sine_cosine_of_turns(-20.0 / 360)));
  return scene.take();
}

}  // namespace

SceneGenerator spd_jacks_generator() {
  return spd_generator(
      {"jacks", "a six-armed jack with half as large ones in its octants, and so on (A. Enzmann)",
       "depth of the recursion: (8^size - 1) / 7 jacks of 6 spheres and 3 cylinders", 4, 8, make_jacks});
}

}  // namespace raymeter
