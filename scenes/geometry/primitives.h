#pragma once
#include <array>
#include <cstdint>

#include "scenes/geometry/bounds.h"
#include "scenes/geometry/vec3.h"

namespace raymeter {

/// Two-sided and closed: its edges and vertices belong to it.
struct Triangle {
  Vec3 a, b, c;
};

enum class QuadricKind : std::uint32_t {
  sphere,    ///< centre `base`, radius `base_radius`; `apex` and `apex_radius` are zero
  cylinder,  ///< a cone whose two radii are equal
  cone,      ///< NFF's `c`: the open lateral surface between two discs, no caps; its rims belong to it
};

/// A quadric surface, two-sided and closed. Radii are >= 0.
struct Quadric {
  QuadricKind kind = QuadricKind::sphere;
  Vec3 base;
  float base_radius = 0;
  Vec3 apex;
  float apex_radius = 0;
};

/// The part inside `clip` of the surface
///   q0 x^2 + q1 y^2 + q2 z^2 + q3 xy + q4 yz + q5 zx + q6 x + q7 y + q8 z + q9 = 0
/// with q the coefficients and (x, y, z) relative to `centre`. Two-sided and closed: where the box cuts it,
/// the cut belongs to it. geometry/quadric_shapes.h makes ellipsoids and the like.
struct GeneralQuadric {
  Vec3 centre;
  std::array<float, 10> coefficients{};
  Bounds clip;  ///< in the scene's coordinates
};

inline Bounds bounds_of(const Triangle& triangle) {
  Bounds box{triangle.a, triangle.a};
  box.extend(triangle.b);
  box.extend(triangle.c);
  return box;
}
/// Contains every point of the surface, exactly; tight to a few ulps.
Bounds bounds_of(const Quadric& quadric);
/// Contains every point of the surface, exactly, and lies within the clip box; wider than the surface by
/// about 1/1000 of it. Empty only if no ray can hit the quadric. Of numbers that are not finite: empty.
Bounds bounds_of(const GeneralQuadric& quadric);

/// Every number is finite.
bool is_finite(const GeneralQuadric& quadric);

}  // namespace raymeter
