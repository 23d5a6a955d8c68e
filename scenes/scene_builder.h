#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenes/geometry/polygon_cutter.h"
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/vec3.h"
#include "scenes/scene.h"

namespace raymeter {

/// Adds primitives to a scene and keeps its optional lists (materials, normals) in step with them: they stay
/// empty until a primitive needs them.
class SceneBuilder {
 public:
  explicit SceneBuilder(SceneData& data) : data_(data) {}

  /// A polygon of at least three corners, each an index into the scene's vertices, with as many indices into
  /// its normals or none. A face with a normal of length 0 has no normals. Returns false when the polygon is
  /// too large to be cut (PolygonCutter::cut).
  bool add_polygon(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> normals = {},
                   std::uint32_t material = 0);

  /// What add_polygon's false means, for messages.
  static std::string too_large(std::size_t corners);

  void add_quadric(const Quadric& quadric, std::uint32_t material = 0);
  void add_quadric(const GeneralQuadric& quadric, std::uint32_t material = 0);

 private:
  SceneData& data_;
  PolygonCutter cutter_;
  std::vector<Vec3> corners_;
};

}  // namespace raymeter
