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
//
// Quadrics are filtered in double, with errors bounded by the 1-norms of what goes in: W of the origin from
// the base, 1..2 of the direction, R of the axis, S for the radius of the surface anywhere on the line
// (`girth`) and m for its change per unit of the direction (`steepness`; both 0 and r for a sphere). The
// vectors perpendicular to the axis are off by at most 48u of W or of the direction (13u R^2/A.A, R^2 <= 3
// A.A, and some), so a, b and c by at most 110u of what Cauchy-Schwarz allows them to be; 2^-44 = 512u is
// used. `tiny_length` pays for denormal inputs. Overflow makes the bounds infinite, and they reject nothing.
//
// General quadrics: filter_general_quadric.cpp.
#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>

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
/// Not inline: an expensive primitive, kept out of the loops over cheap ones.
bool may_hit(const FilterRay& ray, const GeneralQuadric& quadric, float tmax);

inline FilterRay::FilterRay(const Ray& given) : ray(given) {
  // Where the direction is denormal the scaled one would not be.
  const Vec3d d{flushed(ray.direction.x), flushed(ray.direction.y), flushed(ray.direction.z)};
  // The greatest power of two that is not above the norm: its bits less the mantissa.
  const double norm = double(std::abs(d.x)) + std::abs(d.y) + std::abs(d.z);
  if (norm > 0) scale = std::bit_cast<double>(std::bit_cast<std::uint64_t>(norm) & ~std::uint64_t{0} << 52u);
  direction = to_float((1 / scale) * d);
  tnear_scaled = ray.tnear >= 0 ? ray.tnear * scale : -std::numeric_limits<double>::infinity();
}

namespace filter {

inline constexpr float tiny = 0x1p-32f, large = 1e37f;

inline float norm(const Vec3& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) + tiny;
}

/// Certainly no hit: the line in direction d (FilterRay::direction) passes outside the triangle with edges e1
/// and e2 from a vertex, where s = origin - vertex. Without a branch, so that loops over it are vectorised.
inline bool passes_outside(const Vec3& d, const Vec3& s, const Vec3& e1, const Vec3& e2) {
  // The line's barycentric coordinates where it meets the plane, times det, are certainly of different signs.
  const Vec3 p = cross(d, e2), q = cross(s, e1);
  const float det = dot(e1, p), u = dot(s, p), v = dot(d, q), w = det - u - v;
  const float edge = std::max(norm(e1), norm(e2)), reach = norm(s);
  const float area = edge * (edge + 2 * reach), error = 0x1.8p-20f * area;
  const float least = std::min(std::min(u, v), w), greatest = std::max(std::max(u, v), w);
  return bool((least < -error) & (greatest > error) & (area < large));
}

}  // namespace filter

inline bool may_hit(const FilterRay& ray, const Triangle& triangle, float tmax) {
  const Vec3& d = ray.direction;
  const Vec3 e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a, s = ray.ray.origin - triangle.a;
  if (filter::passes_outside(d, s, e1, e2)) return false;

  // t = height / det may lie in (tnear, tmax].
  const Vec3 p = cross(d, e2), q = cross(s, e1);
  const float det = dot(e1, p), edge = std::max(filter::norm(e1), filter::norm(e2)), reach = filter::norm(s);
  const float area = edge * (edge + 2 * reach);
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

inline bool may_hit(const FilterRay& ray, const Quadric& quadric, float tmax) {
  constexpr double tiny_length = 0x1p-60, unit_error = 0x1p-44;
  const auto norm = [](const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };

  // The line's points are at the heights foot + t * along, in lengths of the axis; perpendicular to it they
  // are at w + t * d; and there the surface has the radius + t * slope.
  Vec3d d = to_double(ray.direction), w = to_double(ray.ray.origin) - to_double(quadric.base);
  double radius = quadric.base_radius, slope = 0, along = 0, foot = 0, steepness = 0, per_length = 0;
  const double distance = norm(w) + tiny_length;
  double girth = radius + tiny_length;
  if (quadric.kind != QuadricKind::sphere) {
    const Vec3d axis = to_double(quadric.apex) - to_double(quadric.base);
    const double length = norm(axis), inverse = 1 / dot(axis, axis);
    if (!(length > tiny_length)) return true;
    along = dot(d, axis) * inverse, foot = dot(w, axis) * inverse;
    d = d - along * axis, w = w - foot * axis;
    const double widening = double(quadric.apex_radius) - radius;
    per_length = length * inverse, steepness = std::abs(widening) * per_length;
    slope = widening * along, radius += widening * foot, girth += steepness * distance;
  }

  // a t^2 + 2 b t + c = 0 has certainly no root.
  const double a = dot(d, d) - slope * slope, b = dot(d, w) - slope * radius, c = dot(w, w) - radius * radius;
  const double widest = 1 + steepness * steepness;
  const double discriminant = b * b - a * c;
  const double discriminant_error = 32 * unit_error * widest * (distance * distance + girth * girth);
  if (discriminant < -discriminant_error) return false;
  const double a_error = 4 * unit_error * widest;
  if (!(a > a_error)) return true;

  // Both roots are certainly on one side of h: the left (-1) or the right (1).
  const auto side_of_roots = [&](double h) {
    const double go = 2 * std::abs(h), reach = go + distance, width = steepness * go + girth;
    if (!((a * h + 2 * b) * h + c > unit_error * (reach * reach + width * width))) return 0;
    const double derivative = a * h + b,
                 error = 2 * unit_error * (go * widest + distance + steepness * girth);
    return derivative > error ? -1 : derivative < -error ? 1 : 0;
  };
  // As for triangles: what lies beyond this rounds to a float beyond tmax.
  if (side_of_roots(std::max(tmax, FLT_MIN) * ray.scale * (1 + 0x1p-21)) > 0) return false;
  if (side_of_roots(ray.tnear_scaled) < 0) return false;

  // Both roots are certainly below the base or above the apex (times a).
  if (quadric.kind == QuadricKind::sphere) return true;
  const double middle = foot * a - b * along;
  const double half = std::sqrt(std::max(discriminant, 0.0) + discriminant_error) * std::abs(along);
  const double error =
      64 * unit_error * per_length * (widest * distance + steepness * girth) + 0x1p-40 * half + a_error;
  return !(middle + half < -error || middle - half > a + error);
}

}  // namespace raymeter
