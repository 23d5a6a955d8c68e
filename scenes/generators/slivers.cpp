#include <cmath>

#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

/// Uniform on the unit sphere.
Vec3d random_direction(Random& random) {
  while (true) {
    const Vec3d point = to_double(random_point(random, -1, 1));
    const double square = dot(point, point);
    if (square > 1e-4 && square <= 1) return (1 / std::sqrt(square)) * point;
  }
}

SceneData make_slivers(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const double twice_area = 2 * arguments.number("area"), aspect = arguments.number("aspect");
  const double length = std::sqrt(twice_area * aspect), height = std::sqrt(twice_area / aspect);
  SceneData data;
  for (std::int64_t i = 0; i < arguments.integer("triangles"); ++i) {
    const Vec3d centre = to_double(random_point(random, 0, 1));
    const Vec3d along = random_direction(random);
    Vec3d across = cross(along, random_direction(random));
    while (dot(across, across) < 1e-4) across = cross(along, random_direction(random));
    across = (1 / std::sqrt(dot(across, across))) * across;
    add_triangle(data, to_float(centre - 0.5 * length * along), to_float(centre + 0.5 * length * along),
                 to_float(centre + height * across));
  }
  data.camera = camera_at_cube({0.5f, 0.5f, 0.5f}, 1);
  return data;
}

}  // namespace

SceneGenerator slivers_generator() {
  return {"slivers",
          "long thin triangles at all angles, whose boxes are far larger than they are",
          {{"triangles", ParameterType::integer, "60000", "how many, their middles in the unit cube", 1, 1e8},
           {"aspect", ParameterType::number, "100",
            "length by height of a triangle; its area stays the same, so beyond 2500 they leave the cube", 1,
            1e6},
           {"area", ParameterType::number, "0.0002", "of a triangle", 1e-9, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          make_slivers};
}

}  // namespace raymeter
