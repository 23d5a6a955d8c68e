#pragma once
// What decide.h promises, computed the slow way: all integers, other formulas, no bounds. Shares no code with
// `decide`. Must be called with denormals on.
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cfloat>
#include <cmath>
#include <optional>
#include <vector>

#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"

namespace raymeter::reference {

using Integer =
    boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using Point = Vector3<Integer>;

/// x in units of 2^-149 (every float is a whole number of them); denormals count as zero.
inline Integer units(float x) {
  if (!std::isnormal(x)) return 0;
  int exponent = 0;
  const float fraction = std::frexp(x, &exponent);
  return Integer(static_cast<long>(std::ldexp(fraction, 24))) << (exponent - 24 + 149);
}
inline Point units(const Vec3& v) {
  return {units(v.x), units(v.y), units(v.z)};
}
inline const Integer one_unit = Integer(1) << 149;

/// The rounding of decide.h, of numerator / denominator.
inline float round_fraction(Integer numerator, Integer denominator) {
  if (numerator == 0) return 0;
  const bool negative = (numerator < 0) != (denominator < 0);
  numerator = abs(numerator), denominator = abs(denominator);
  // A quotient of at least 40 bits, its last bit set when anything is left over.
  const int shift = 42 - (int(msb(numerator)) - int(msb(denominator)));
  if (shift > 0)
    numerator <<= shift;
  else
    denominator <<= -shift;
  Integer quotient, rest;
  divide_qr(numerator, denominator, quotient, rest);
  if (rest != 0) quotient |= 1;
  // Clamped far outside of the floats, where the exponent no longer matters.
  const double value = std::ldexp(quotient.convert_to<double>(), std::clamp(-shift, -400, 400));
  if (value < double(FLT_MIN)) return 0;
  const float result = value > double(FLT_MAX) ? no_hit : static_cast<float>(value);
  return negative ? -result : result;
}

inline float flush(float x) {
  return std::fpclassify(x) == FP_SUBNORMAL ? 0.0f : x;
}

inline float in_interval(const Ray& ray, float t) {
  return flush(ray.tnear) < t && t <= flush(ray.tfar) && std::isfinite(t) ? t : no_hit;
}

inline bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool can_hit(const Ray& ray) {
  const auto zero = [](const Vec3& v) {
    return !std::isnormal(v.x) && !std::isnormal(v.y) && !std::isnormal(v.z);
  };
  return finite(ray.origin) && finite(ray.direction) && !zero(ray.direction) && !std::isnan(ray.tnear) &&
         !std::isnan(ray.tfar);
}

/// Meets the plane first, then asks in a coordinate plane whether that point is inside.
inline float decide(const Ray& ray, const Triangle& triangle) {
  if (!can_hit(ray) || !finite(triangle.a) || !finite(triangle.b) || !finite(triangle.c)) return no_hit;
  const Point o = units(ray.origin), d = units(ray.direction);
  const Point p[3] = {units(triangle.a), units(triangle.b), units(triangle.c)};
  const Point normal = cross(p[1] - p[0], p[2] - p[0]);
  const Integer slope = dot(normal, d);
  if (slope == 0) return no_hit;
  const Integer rise = dot(normal, p[0]) - dot(normal, o);  // t = rise / slope
  int drop = 0;
  while (normal[drop] == 0) ++drop;
  const int i = (drop + 1) % 3, j = (drop + 2) % 3;
  // The point times slope.
  const Integer x = o[i] * slope + rise * d[i], y = o[j] * slope + rise * d[j];
  bool left = false, right = false;
  for (int k = 0; k < 3; ++k) {
    const Point &from = p[k], &to = p[(k + 1) % 3];
    const Integer side =
        (to[i] - from[i]) * (y - from[j] * slope) - (to[j] - from[j]) * (x - from[i] * slope);
    left |= side > 0, right |= side < 0;
  }
  return left && right ? no_hit : in_interval(ray, round_fraction(rise, slope));
}

}  // namespace raymeter::reference
