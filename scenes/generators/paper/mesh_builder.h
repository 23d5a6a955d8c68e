#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace raymeter {

/// A point of the outline of a turned body: its distance from the axis, and its height.
struct OutlinePoint {
  double radius, height;
  bool sharp = false;  ///< the outline has a corner here, which shading shows
};

/// A closed ring of points, counter-clockwise seen from above, or a single point where a body ends.
struct Ring {
  std::vector<Vec3d> points;
  bool sharp = false;  ///< the surface has an edge here, which shading shows
};

/// Turns an outline, given from its lowest to its highest point, about an upright axis through `foot`: a ring
/// for each of its points. A radius of 0 makes a single point.
std::vector<Ring> turned_rings(const Vec3d& foot, std::span<const OutlinePoint> outline, std::uint32_t sides);

/// Adds bodies made of triangles to a scene. y is up; triangles are counter-clockwise seen from outside.
class MeshBuilder {
 public:
  explicit MeshBuilder(SceneData& data) : data_(data) {}

  /// Of what is added from here on. Returns its number.
  std::uint32_t add_material(const Material& material);
  void use_material(std::uint32_t material) { material_ = material; }

  /// Two flat triangles: a, b, c, d counter-clockwise.
  void add_quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
  /// Two triangles with a shading normal at each corner.
  void add_smooth_quad(const std::array<Vec3d, 4>& corners, const std::array<Vec3d, 4>& normals);
  /// An upright box: 12 triangles.
  void add_box(const Vec3d& low, const Vec3d& high);
  /// The surface through rings from the lowest to the highest; all that are not single points have equally
  /// many points. Between two rings of n points are 2 n triangles, between a ring and a single point n.
  void add_loft(std::span<const Ring> rings);
  /// The loft through turned_rings.
  void add_lathe(const Vec3d& foot, std::span<const OutlinePoint> outline, std::uint32_t sides);

 private:
  void add_triangle(const std::array<std::uint32_t, 3>& corners, const std::array<std::uint32_t, 3>& normals);
  std::uint32_t add_vertex(const Vec3d& point);
  std::uint32_t add_normal(const Vec3d& direction);

  SceneData& data_;
  std::uint32_t material_ = 0;
};

}  // namespace raymeter
