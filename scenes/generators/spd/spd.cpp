#include "scenes/generators/spd/spd.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/generators/families.h"

namespace raymeter {

std::vector<SceneGenerator> spd_generators() {
  return {spd_balls_generator(), spd_gears_generator(), spd_jacks_generator(),    spd_lattice_generator(),
          spd_mount_generator(), spd_rings_generator(), spd_sombrero_generator(), spd_teapot_generator(),
          spd_tetra_generator(), spd_tree_generator()};
}

SceneGenerator spd_generator(const SpdFamily& family) {
  return {"spd/" + family.name,
          family.summary,
          {{"size", ParameterType::integer, fmt::format("{}", family.default_size), family.size_meaning,
            static_cast<double>(family.smallest_size), static_cast<double>(family.largest_size)}},
          [make = family.make](const Arguments& arguments) {
            return make(static_cast<int>(arguments.integer("size")));
          }};
}

Material spd_matte(const Vec3& colour) {
  return {colour, 1, 0, spd_no_highlight, 0, 0};
}

SpdScene::SpdScene(const Camera& camera, std::initializer_list<Vec3> lights, const Vec3& background) {
  data_.camera = camera;
  for (const Vec3& position : lights) data_.lights.push_back({position, {1, 1, 1}});
  data_.background = background;
}

void SpdScene::fill(const Material& material) {
  auto& known = data_.materials;
  const auto found = std::ranges::find(known, material);
  material_ = static_cast<std::uint32_t>(found - known.begin());
  if (found == known.end()) known.push_back(material);
}

void SpdScene::sphere(const Vec3d& centre, double radius) {
  builder_.add_quadric({QuadricKind::sphere, to_float(centre), static_cast<float>(radius), {}, 0}, material_);
  ++data_.shapes;
}

void SpdScene::cone(const Vec3d& base, double base_radius, const Vec3d& apex, double apex_radius) {
  const QuadricKind kind = base_radius == apex_radius ? QuadricKind::cylinder : QuadricKind::cone;
  builder_.add_quadric({kind, to_float(base), static_cast<float>(base_radius), to_float(apex),
                        static_cast<float>(apex_radius)},
                       material_);
  ++data_.shapes;
}

std::uint32_t SpdScene::vertex(const Vec3d& position) {
  data_.vertices.push_back(to_float(position));
  return static_cast<std::uint32_t>(data_.vertices.size() - 1);
}

std::uint32_t SpdScene::normal(const Vec3d& direction) {
  data_.normals.push_back(to_float(direction));
  return static_cast<std::uint32_t>(data_.normals.size() - 1);
}

void SpdScene::polygon(std::initializer_list<Vec3d> corners) {
  corners_.clear();
  for (const Vec3d& corner : corners) corners_.push_back(vertex(corner));
  polygon(corners_);
}

void SpdScene::polygon(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> normals) {
  if (!builder_.add_polygon(vertices, normals, material_))
    throw Error(SceneBuilder::too_large(vertices.size()));
  ++data_.shapes;
}

}  // namespace raymeter
