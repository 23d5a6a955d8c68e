#include "scenes/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace raymeter {
namespace {

template <class Shape>
void add(const Shape& shape, std::vector<Shape>& shapes, std::uint32_t material,
         std::vector<std::uint32_t>& materials) {
  const bool with_materials = material != 0 || !materials.empty();
  if (with_materials) materials.resize(shapes.size(), 0);
  shapes.push_back(shape);
  if (with_materials) materials.push_back(material);
}

}  // namespace

bool SceneBuilder::add_polygon(std::span<const std::uint32_t> vertices,
                               std::span<const std::uint32_t> normals, std::uint32_t material) {
  corners_.clear();
  for (const std::uint32_t vertex : vertices) corners_.push_back(data_.vertices[vertex]);
  if (!cutter_.cut(corners_)) return false;

  if (std::ranges::any_of(normals, [&](std::uint32_t n) { return data_.normals[n] == Vec3{}; })) normals = {};
  constexpr std::array none{SceneData::no_normal, SceneData::no_normal, SceneData::no_normal};
  const bool with_normals = !normals.empty() || !data_.triangle_normals.empty();
  const bool with_materials = material != 0 || !data_.triangle_materials.empty();
  if (with_normals) data_.triangle_normals.resize(data_.triangles.size(), none);
  if (with_materials) data_.triangle_materials.resize(data_.triangles.size(), 0);

  for (const auto& [a, b, c] : cutter_.triangles()) {
    data_.triangles.push_back({vertices[a], vertices[b], vertices[c]});
    if (with_normals)
      data_.triangle_normals.push_back(normals.empty() ? none
                                                       : std::array{normals[a], normals[b], normals[c]});
    if (with_materials) data_.triangle_materials.push_back(material);
  }
  return true;
}

std::string SceneBuilder::too_large(std::size_t corners) {
  return fmt::format("a concave polygon of {} corners; the limit is {}", corners,
                     PolygonCutter::most_clipped_corners);
}

void SceneBuilder::add_quadric(const Quadric& quadric, std::uint32_t material) {
  add(quadric, data_.quadrics, material, data_.quadric_materials);
}

void SceneBuilder::add_quadric(const GeneralQuadric& quadric, std::uint32_t material) {
  add(quadric, data_.general_quadrics, material, data_.general_quadric_materials);
}

}  // namespace raymeter
