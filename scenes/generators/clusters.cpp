#include <vector>

#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

constexpr double smallest_side = 0x1p-10;

void add_object(SceneData& data, Random& random, const std::string& primitive, const Vec3& centre,
                float size) {
  if (primitive == "triangle") {
    add_random_triangle(data, random, centre, size);
  } else if (primitive == "sphere") {
    data.quadrics.push_back({QuadricKind::sphere, centre, random.uniform(0.25f * size, size), {}, 0});
  } else {
    Quadric cone{QuadricKind::cone, centre, random.uniform(0.25f * size, 0.5f * size), {}, 0};
    cone.apex = centre + random_point(random, -size, size);
    cone.apex_radius = random.uniform(0, cone.base_radius);
    data.quadrics.push_back(cone);
  }
}

SceneData make_clusters(const Arguments& arguments) {
  Random random(static_cast<std::uint64_t>(arguments.integer("seed")));
  const std::string& primitive = arguments.text("primitive");
  const double side_exact = 1 - arguments.number("clustering") * (1 - smallest_side);
  const auto side = static_cast<float>(side_exact);
  const auto room = static_cast<float>(1 - side_exact);
  const auto size = static_cast<float>(arguments.number("size") * side_exact);

  // A cluster is a cube of this side anywhere in the unit cube; at clustering 0 all are the whole of it.
  std::vector<Vec3> corners;
  for (std::int64_t i = 0; i < arguments.integer("clusters"); ++i)
    corners.push_back(random_point(random, 0, room));

  SceneData data;
  for (std::int64_t i = 0; i < arguments.integer("objects"); ++i) {
    const Vec3& corner = corners[random.below(static_cast<std::uint32_t>(corners.size()))];
    const Vec3 centre = corner + random_point(random, 0, side);
    add_object(data, random, primitive, centre, size);
  }
  // One cluster fills the picture, others stand behind it: a view of all would be a view of the gaps.
  data.camera = camera_at_cube(corners[0] + 0.5f * Vec3{side, side, side}, side);
  return data;
}

}  // namespace

SceneGenerator clusters_generator() {
  return {"clusters",
          "objects crowded in clusters, from evenly spread to a teapot in a stadium by one knob",
          {{"objects", ParameterType::integer, "60000", "how many", 1, 1e8},
           {.name = "primitive",
            .type = ParameterType::choice,
            .default_value = "triangle",
            .meaning = "what they are",
            .choices = {"triangle", "sphere", "cone"}},
           {"clusters", ParameterType::integer, "16", "how many clusters share them", 1, 1e6},
           {"clustering", ParameterType::number, "0.8",
            "0: evenly spread, 1: in clusters of 1/1024 of the unit cube's side, which shrinks in proportion",
            0, 1},
           {"size", ParameterType::number, "0.03", "reach of an object, as a part of its cluster's side",
            1e-4, 1},
           {"seed", ParameterType::integer, "1", "of the random numbers", 0, 1e9}},
          make_clusters};
}

}  // namespace raymeter
