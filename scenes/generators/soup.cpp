#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {

SceneGenerator soup_generator() {
  return {"soup",
          "random triangles, evenly spread: what a uniform grid is best at",
          {{"triangles", ParameterType::integer, "60000", "how many", 1, 1e8},
           {"size", ParameterType::number, "0.02",
            "corners lie within this of their centre, along each axis of the unit cube", 1e-6, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          [](const Arguments& arguments) {
            Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
            const auto size = static_cast<float>(arguments.number("size"));
            SceneData data;
            for (std::int64_t i = 0; i < arguments.integer("triangles"); ++i) {
              const Vec3 centre = random_point(random, 0, 1);
              add_random_triangle(data, random, centre, size);
            }
            data.camera = camera_at_cube({0.5f, 0.5f, 0.5f}, 1);
            return data;
          }};
}

}  // namespace raymeter
