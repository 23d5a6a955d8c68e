#include "scenes/base/random.h"
#include "scenes/generators/families.h"

namespace raymeter {

SceneGenerator soup_generator() {
  return {"soup",
          "random triangles, evenly spread: what a uniform grid is best at",
          {{"triangles", ParameterType::integer, "60000", "how many", 1, 1e8},
           {"size", ParameterType::number, "0.02", "edge length as a part of the unit cube", 1e-6, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          [](const Arguments& arguments) {
            Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
            const auto size = static_cast<float>(arguments.number("size"));
            SceneData data;
            for (std::uint32_t i = 0; i < arguments.integer("triangles"); ++i) {
              const Vec3 centre{random.uniform(), random.uniform(), random.uniform()};
              for (int corner = 0; corner < 3; ++corner) {
                const float x = random.uniform(-size, size), y = random.uniform(-size, size);
                data.vertices.push_back(centre + Vec3{x, y, random.uniform(-size, size)});
              }
              data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
            }
            return data;
          }};
}

}  // namespace raymeter
