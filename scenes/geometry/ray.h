#pragma once
#include <cstdint>
#include <limits>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// A ray asks for hits at origin + t * direction with tnear < t <= tfar, t in units of |direction|.
/// tfar = +inf is ordinary. 32 bytes, no padding.
struct Ray {
  Vec3 origin;
  float tnear = 0;
  Vec3 direction;
  float tfar = std::numeric_limits<float>::infinity();
};
static_assert(sizeof(Ray) == 32);

/// A ray that can hit anything: no NaN, origin and direction finite, direction not zero.
/// All others miss everything, in every structure.
inline bool is_traceable(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && !(ray.direction == Vec3{}) &&
         !std::isnan(ray.tnear) && !std::isnan(ray.tfar);
}

inline constexpr std::uint32_t no_primitive = 0xffffffffu;
/// In place of a primitive: a foreign structure does not accept this ray, though it may hit something. No own
/// structure ever answers so; it is graded `not_given`.
inline constexpr std::uint32_t not_answered = 0xfffffffeu;
/// The same for an any-hit query, in place of 0 or 1.
inline constexpr std::uint8_t occlusion_not_answered = 2;
/// What `decide` returns for a miss, and the t of a Hit that is none.
inline constexpr float no_hit = std::numeric_limits<float>::infinity();

/// The answer to a closest-hit query: of all hits in the ray's interval the one with the least (t,
/// primitive).
struct Hit {
  float t = no_hit;
  std::uint32_t primitive = no_primitive;

  bool found() const { return primitive < not_answered; }
  friend bool operator==(const Hit&, const Hit&) = default;
  /// The order of hits along a ray: by t, then by primitive.
  friend bool operator<(const Hit& a, const Hit& b) {
    return a.t < b.t || (a.t == b.t && a.primitive < b.primitive);
  }
};

}  // namespace raymeter
