#include <algorithm>
#include <cmath>

#include "scenes/base/portable_math.h"
#include "scenes/generators/families.h"
#include "scenes/generators/random_shapes.h"

namespace raymeter {
namespace {

struct Knot {
  Vec3d point, tangent;
};

/// A trefoil about the z axis, less than 2 units wide, at u in 0 .. 1.
Knot trefoil(double u) {
  const auto [s2, c2] = sine_cosine(4 * pi * u);
  const auto [s3, c3] = sine_cosine(6 * pi * u);
  const double r = 0.6 + 0.25 * c3;
  const double dr = -0.75 * s3;  // by 2 pi u, as the derivatives below
  return {{r * c2, r * s2, 0.25 * s3}, {dr * c2 - 2 * r * s2, dr * s2 + 2 * r * c2, 0.75 * c3}};
}

/// A tube along the knot, of `around` by `along` quadrilaterals.
void add_tube(SceneData& data, std::uint32_t around, std::uint32_t along) {
  constexpr double thickness = 0.16;
  for (std::uint32_t i = 0; i < along; ++i) {
    const Knot knot = trefoil(double(i) / along);
    const Vec3d ahead = normalized(knot.tangent);
    const Vec3d side = normalized(cross(ahead, Vec3d{0, 0, 1})), up = cross(side, ahead);
    for (std::uint32_t j = 0; j < around; ++j) {
      const auto [sine, cosine] = sine_cosine(2 * pi * j / around);
      const Vec3d outward = cosine * side + sine * up;
      data.vertices.push_back(to_float(knot.point + thickness * outward + Vec3d{0, 0, 0.45}));
      data.normals.push_back(to_float(outward));
    }
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return i % along * around + j % around; };
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      data.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      data.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  data.triangle_normals = data.triangles;
}

SceneData make_stadium(const Arguments& arguments) {
  // About square facets: the knot is some 12 times as long as it is round.
  const double quads = 0.5 * double(arguments.integer("triangles") - 2);
  const auto around = static_cast<std::uint32_t>(std::max(3.0, std::round(std::sqrt(quads / 12))));
  const auto along = static_cast<std::uint32_t>(std::max(3.0, std::round(quads / around)));
  SceneData data;
  add_tube(data, around, along);
  Bounds knot;
  for (const Vec3& vertex : data.vertices) knot.extend(vertex);
  const auto half = static_cast<float>(0.5 * arguments.number("ratio") * knot.extent().x);
  data.triangle_materials.assign(data.triangles.size(), 0);

  const auto first = static_cast<std::uint32_t>(data.vertices.size());
  data.vertices.insert(data.vertices.end(),
                       {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}});
  for (const std::uint32_t corner : {1u, 2u}) {
    data.triangles.push_back({first, first + corner, first + corner + 1});
    data.triangle_normals.push_back({SceneData::no_normal, SceneData::no_normal, SceneData::no_normal});
    data.triangle_materials.push_back(1);
  }
  data.materials = {{.colour = {0.9f, 0.45f, 0.15f}, .diffuse = 0.7f, .specular = 0.3f, .shine = 40},
                    {.colour = {0.35f, 0.45f, 0.4f}, .diffuse = 0.9f, .specular = 0, .shine = 1}};
  data.lights = {{{4, -6, 8}, {1, 1, 1}}};
  data.camera = Camera{.from = {1.2f, -2.6f, 2.2f}, .at = {0, 0, 0.35f}, .up = {0, 0, 1}, .angle = 42};
  return data;
}

}  // namespace

SceneGenerator stadium_generator() {
  return {
      "stadium",
      "a finely meshed knot on a ground of two triangles: the teapot in a stadium",
      {{"triangles", ParameterType::integer, "60000", "about how many: of the knot's mesh, and two", 20, 1e8},
       {"ratio", ParameterType::number, "100", "how many times wider the ground is than the knot", 1, 1e6}},
      make_stadium};
}

}  // namespace raymeter
