#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

/// Corners of the unit cube that keep the scene's box as it is.
constexpr std::int64_t corner_triangles = 8;

SceneData make_crowding(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const auto kappa = static_cast<float>(arguments.number("kappa"));
  const auto size = static_cast<float>(arguments.number("size")) * kappa;
  const float low = 0.5f - 0.5f * kappa;
  SceneData data;
  for (std::int64_t i = corner_triangles; i < arguments.integer("triangles"); ++i) {
    const Vec3 centre = random_point(random, low, low + kappa);
    add_random_triangle(data, random, centre, size);
  }
  for (unsigned corner = 0; corner < corner_triangles; ++corner) {
    Vec3 tip, along_x, along_y;
    for (int axis = 0; axis < 3; ++axis) tip[axis] = corner >> static_cast<unsigned>(axis) & 1u ? 1.0f : 0.0f;
    along_x = along_y = tip;
    along_x.x += tip.x > 0 ? -size : size;
    along_y.y += tip.y > 0 ? -size : size;
    add_triangle(data, tip, along_x, along_y);
  }
  data.camera = camera_at_cube({0.5f, 0.5f, 0.5f}, kappa);
  return data;
}

}  // namespace

SceneGenerator crowding_generator() {
  return {
      "crowding",
      "a soup shrunk into the middle of its box: how crowded until a grid is too coarse there?",
      {{"triangles", ParameterType::integer, "60000", "how many, 8 of them in the corners of the box", 9,
        1e8},
       {"kappa", ParameterType::number, "0.1",
        "side of the cube that holds the triangles, as a part of the box's; they shrink with it", 1e-4, 1},
       {"size", ParameterType::number, "0.02",
        "corners lie within this of their centre, as a part of that cube's side", 1e-6, 1},
       {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
      make_crowding};
}

}  // namespace raymeter
