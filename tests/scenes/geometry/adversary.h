#pragma once
// Numbers, points and rays that numerical code gets wrong.
#include <cfloat>
#include <cmath>
#include <iterator>

#include "scenes/base/random.h"
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"

namespace raymeter::adversary {

/// The ways in which numbers are drawn, from natural to vicious.
enum class Style { natural, halves, small_integers, far_away, mixed_scales, extremes };
inline constexpr Style styles[] = {Style::natural,  Style::halves,       Style::small_integers,
                                   Style::far_away, Style::mixed_scales, Style::extremes};

inline float number(Random& random, Style style) {
  static constexpr float odd_ones[] = {0.0f,   -0.0f,   1.0f,    -1.0f,    FLT_MAX,     -FLT_MAX, FLT_MIN,
                                       1e-40f, -1e-45f, 3e38f,   1.5e-38f, 16777216.0f, 0.1f,     -FLT_MIN,
                                       1e30f,  -1e-30f, 0x1p63f, 0x1p-63f, 1.0000001f,  2e19f,    -3e-20f};
  switch (style) {
    case Style::natural:
      return random.uniform(-1, 1);
    case Style::halves:
      return float(int(random.below(17)) - 8) / 2;
    case Style::small_integers:
      return float(int(random.below(5)) - 2);
    case Style::far_away:
      return 1e6f + random.uniform(-1, 1);
    case Style::mixed_scales:
      return std::ldexp(random.uniform(-1, 1), int(random.below(200)) - 100);
    case Style::extremes:
      return odd_ones[random.below(std::size(odd_ones))];
  }
  return 0;
}

inline Vec3 point(Random& random, Style style) {
  return {number(random, style), number(random, style), number(random, style)};
}

/// A ray towards `target`, now and then exactly, along an axis, scaled, or from near by.
inline Ray ray_towards(Random& random, Style style, const Vec3& target) {
  Ray ray;
  ray.origin = point(random, style);
  ray.direction = target - ray.origin;
  switch (random.below(6)) {
    case 0:
      break;
    case 1: {  // along an axis, with zeros of either sign, from a point that shares two coordinates
      const int axis = int(random.below(3));
      ray.direction = Vec3{random.below(2) ? 0.0f : -0.0f, random.below(2) ? 0.0f : -0.0f, -0.0f};
      ray.direction[axis] = random.below(2) ? 1.0f : -2.5f;
      const float along = ray.origin[axis];
      ray.origin = target;
      ray.origin[axis] = along;
      break;
    }
    case 2: {  // a power of two longer or shorter
      const float scale = std::ldexp(1.0f, int(random.below(240)) - 120);
      ray.direction = scale * ray.direction;
      break;
    }
    case 3:
      ray.direction = point(random, style);
      break;
    case 4: {  // perpendicular to an axis
      const int axis = int(random.below(3));
      ray.origin[axis] = target[axis];
      ray.direction[axis] = -0.0f;
      break;
    }
    default: {  // one ulp off
      const int axis = int(random.below(3));
      ray.direction[axis] = std::nextafter(ray.direction[axis], random.below(2) ? 1e38f : -1e38f);
      break;
    }
  }
  return ray;
}

/// The weighted mean of the corners, often a corner or the middle of an edge.
inline Vec3 point_on(Random& random, const Triangle& triangle) {
  const Vec3 half_ab = 0.5f * triangle.a + 0.5f * triangle.b;
  switch (random.below(6)) {
    case 0:
      return triangle.a;
    case 1:
      return triangle.c;
    case 2:
      return half_ab;
    case 3:
      return 0.5f * triangle.b + 0.5f * triangle.c;
    default: {
      const float u = random.uniform(-0.2f, 1.2f), v = random.uniform(-0.2f, 1.2f);
      return triangle.a + u * (triangle.b - triangle.a) + v * (triangle.c - triangle.a);
    }
  }
}

/// Now and then degenerate.
inline Triangle triangle(Random& random, Style style) {
  Triangle result{point(random, style), point(random, style), point(random, style)};
  switch (random.below(16)) {
    case 0:
      result.b = result.a;
      break;
    case 1:
      result.c = 0.5f * result.a + 0.5f * result.b;
      break;
    case 2:
      result.c = result.a + 0x1p-20f * (result.b - result.a) + Vec3{0, 1e-7f, 0};
      break;
    default:
      break;
  }
  return result;
}

/// Of any kind; often with a tip, an axis along a coordinate axis, no radius or no length.
inline Quadric quadric(Random& random, Style style) {
  Quadric q;
  q.kind = static_cast<QuadricKind>(random.below(3));
  q.base = point(random, style);
  q.base_radius = std::abs(number(random, style));
  if (q.kind == QuadricKind::sphere) return q;
  q.apex = point(random, style);
  q.apex_radius = q.kind == QuadricKind::cylinder ? q.base_radius : std::abs(number(random, style));
  switch (random.below(8)) {
    case 0:
    case 1:
    case 2: {
      const int axis = int(random.below(3));
      const float along = q.apex[axis];
      q.apex = q.base;
      q.apex[axis] = along;
      break;
    }
    case 3:
      q.apex_radius = 0;
      break;
    case 4:
      q.base_radius = 0;
      break;
    case 5:
      if (random.below(8) == 0) q.apex = q.base;
      break;
    default:
      break;
  }
  if (q.kind == QuadricKind::cylinder) q.apex_radius = q.base_radius;
  return q;
}

/// A ray at the tip, rim, silhouette or along a generator of a quadric, or near one.
inline Ray ray_towards(Random& random, Style style, const Quadric& q) {
  const int axis = int(random.below(3));
  Vec3 out{};
  out[axis] = random.below(2) ? 1.0f : -1.0f;
  const bool sphere = q.kind == QuadricKind::sphere;
  const Vec3 rim = q.base + q.base_radius * out, other = q.apex + q.apex_radius * out;
  switch (random.below(8)) {
    case 0:
      return ray_towards(random, style, q.base);
    case 1:
      return ray_towards(random, style, sphere ? rim : q.apex);
    case 2:
      return ray_towards(random, style, rim);
    case 3:
      return ray_towards(random, style, sphere ? rim : 0.5f * rim + 0.5f * other);
    case 4: {  // in the tangent plane at the rim
      Vec3 along = point(random, style);
      along[axis] = 0;
      return {rim - along, 0, random.below(2) ? along : 2.0f * along};
    }
    case 5: {  // parallel to a generator or to the axis, on it or beside it
      const Vec3 direction = sphere ? out : random.below(2) ? other - rim : q.apex - q.base;
      return {random.below(2) ? rim - direction : point(random, style), 0, direction};
    }
    case 6:
      return {rim, 0, point(random, style)};  // from the surface
    default: {
      const Vec3 near{random.uniform(-1.2f, 1.2f), random.uniform(-1.2f, 1.2f), random.uniform(-1.2f, 1.2f)};
      const float along = sphere ? 0.0f : random.uniform();
      return ray_towards(random, style, q.base + along * (q.apex - q.base) + q.base_radius * near);
    }
  }
}

/// Puts the ends of the interval on or beside the hit at t.
inline void tempt_interval(Random& random, Ray& ray, float t) {
  if (t == no_hit) return;
  switch (random.below(6)) {
    case 0:
      ray.tfar = t;
      break;
    case 1:
      ray.tfar = std::nextafter(t, -FLT_MAX);
      break;
    case 2:
      ray.tnear = t;
      break;
    case 3:
      ray.tnear = std::nextafter(t, -FLT_MAX);
      break;
    default:
      break;
  }
}

/// No component that becomes denormal or infinite when it is scaled by 2^60 or 2^-60.
inline bool bears_scaling(const Ray& ray) {
  for (int axis = 0; axis < 3; ++axis) {
    const float size = std::abs(ray.direction[axis]);
    if (size != 0 && (size < 1e-6f || size > 1e6f)) return false;
  }
  return true;
}

}  // namespace raymeter::adversary
