#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

SceneData make_two_scales(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const auto small = static_cast<float>(1 / arguments.number("ratio"));
  const auto size = static_cast<float>(arguments.number("size"));
  const std::int64_t triangles = arguments.integer("triangles");
  SceneData data;
  for (std::int64_t i = 0; i < triangles; ++i) {
    const bool is_small = 2 * i >= triangles;
    // The small soup stands beside the large one, on the same ground.
    const Vec3 corner = is_small ? Vec3{1 + small, 0, 0.5f} : Vec3{0, 0, 0};
    const float scale = is_small ? small : 1;
    const Vec3 centre = corner + random_point(random, 0, scale);
    add_random_triangle(data, random, centre, size * scale);
  }
  data.camera = camera_at_cube({0.5f, 0.5f, 0.5f}, 1);
  return data;
}

}  // namespace

SceneGenerator two_scales_generator() {
  return {"two-scales",
          "two soups side by side, alike but for their scale: no one resolution suits both",
          {{"triangles", ParameterType::integer, "60000", "how many, half of them in each soup", 2, 1e8},
           {"ratio", ParameterType::number, "30", "how many times larger one soup is than the other", 1, 1e5},
           {"size", ParameterType::number, "0.025",
            "corners lie within this of their centre, as a part of the side of their soup", 1e-6, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          make_two_scales};
}

}  // namespace raymeter
