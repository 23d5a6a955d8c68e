#pragma once
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

Bounds bounds_of(const Triangle& triangle);
/// Contains every point of the surface, exactly; tight to a few ulps.
Bounds bounds_of(const Quadric& quadric);

}  // namespace raymeter
