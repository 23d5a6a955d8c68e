#pragma once
// Conservative tests in front of `decide`: they may say `false` only where `decide` would give no_hit, or a
// t above `tmax`. They are inline and hold for any compiler flags that keep to IEEE arithmetic (contraction
// included, -ffast-math not) and for any mode of denormals.
//
// Triangles are filtered in float, after Moeller & Trumbore ("Fast, Minimum Storage Ray/Triangle
// Intersection", 1997) but without the division. The error bounds are those of decide_triangle.cpp with u =
// 2^-24: 7u times the norms of the factors for u, v and det, 8u for the height, and 18u for w = det - u - v;
// the direction is scaled to a 1-norm of 1..2, so u, v and det need twice that. Two things are added. Where
// the bound itself is below `large`, nothing has overflowed. And each flushed or denormal intermediate is off
// by up to 2^-126, the thirty or so of them by less than 2^-120 times the norms: `tiny`, added to the norms,
// pays for these (tiny^3 * 2^-20 = 2^-116).
#include <algorithm>
#include <cfloat>
#include <cmath>

#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {

/// A ray made ready for many primitive tests.
struct FilterRay {
  explicit FilterRay(const Ray& given);

  Ray ray;
  Vec3 direction;       ///< ray.direction / scale
  double scale = 1;     ///< a power of two: t for the scaled direction is t * scale
  double tnear_scaled;  ///< the last t that is certainly too near, -inf if unknown
};

/// False only where decide(ray, triangle) is no_hit or greater than tmax.
bool may_hit(const FilterRay& ray, const Triangle& triangle, float tmax);
bool may_hit(const FilterRay& ray, const Quadric& quadric, float tmax);

inline FilterRay::FilterRay(const Ray& given) : ray(given) {
  // Where the direction is denormal the scaled one would not be.
  const Vec3d d{flushed(ray.direction.x), flushed(ray.direction.y), flushed(ray.direction.z)};
  int exponent = 0;
  std::frexp(std::abs(d.x) + std::abs(d.y) + std::abs(d.z), &exponent);
  scale = std::ldexp(1.0, exponent - 1);
  direction = to_float((1 / scale) * d);
  tnear_scaled = ray.tnear >= 0 ? ray.tnear * scale : -std::numeric_limits<double>::infinity();
}

namespace filter {

inline constexpr float tiny = 0x1p-32f, large = 1e37f;

inline float norm(const Vec3& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) + tiny;
}

}  // namespace filter

inline bool may_hit(const FilterRay& ray, const Triangle& triangle, float tmax) {
  // The line's barycentric coordinates where it meets the plane, times det.
  const Vec3& d = ray.direction;
  const Vec3 e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a, s = ray.ray.origin - triangle.a;
  const Vec3 p = cross(d, e2), q = cross(s, e1);
  const float det = dot(e1, p), u = dot(s, p), v = dot(d, q), w = det - u - v;

  // Certainly of different signs: the line passes outside.
  const float edge = std::max(filter::norm(e1), filter::norm(e2)), reach = filter::norm(s);
  const float area = edge * (edge + 2 * reach), error = 0x1.8p-20f * area;
  const float least = std::min(std::min(u, v), w), greatest = std::max(std::max(u, v), w);
  if (least < -error && greatest > error && area < filter::large) return false;

  // t = height / det may lie in (tnear, tmax].
  const float height = dot(e2, q), volume = edge * edge * reach, det_error = 0x1p-20f * edge * edge;
  if (!(area < filter::large && volume < filter::large && std::abs(det) > det_error)) return true;
  // In double, for the exponents of the products.
  const double height_error = 0x1p-20 * volume, signed_height = det > 0 ? height : -height;
  const double least_det = std::abs(det) - double(det_error),
               greatest_det = std::abs(det) + double(det_error);
  // A t beyond `limit` rounds to a float beyond tmax; one below FLT_MIN would round to 0.
  const double limit = std::max(tmax, FLT_MIN) * ray.scale * (1 + 0x1p-21);
  return !(signed_height - height_error > limit * greatest_det ||
           signed_height + height_error < ray.tnear_scaled * least_det * (1 - 0x1p-21));
}

inline bool may_hit(const FilterRay&, const Quadric&, float) {
  return true;
}

}  // namespace raymeter
