#include <algorithm>

#include "scenes/base/portable_math.h"
#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

/// Nearly normal, of mean 0 and variance 1, between -6 and 6: the sum of twelve uniform numbers less 6.
double nearly_normal(Random& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += random.uniform();
  return sum;
}

SceneData make_sizes(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const double sigma = arguments.number("sigma"), size = arguments.number("size");
  SceneData data;
  for (std::int64_t i = 0; i < arguments.integer("triangles"); ++i) {
    const Vec3 centre = random_point(random, 0, 1);
    // The mean square of a log-normal number is e^(2 sigma^2) times its median's: so the mean area stays.
    const double reach = size * exponential(sigma * nearly_normal(random) - sigma * sigma);
    add_random_triangle(data, random, centre, static_cast<float>(std::clamp(reach, 1e-9, 0.5)));
  }
  data.camera = camera_at_cube({0.5f, 0.5f, 0.5f}, 1);
  return data;
}

}  // namespace

SceneGenerator sizes_generator() {
  return {"sizes",
          "a soup of triangles of very different sizes: how much spread until one cell size suits none?",
          {{"triangles", ParameterType::integer, "60000", "how many", 1, 1e8},
           {"sigma", ParameterType::number, "1",
            "standard deviation of the logarithm of their sizes; the mean area stays the same", 0, 2},
           {"size", ParameterType::number, "0.02",
            "root mean square of the reach of their corners along each axis; a reach above 0.5 is cut", 1e-6,
            0.5},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          make_sizes};
}

}  // namespace raymeter
