#pragma once
// How real numbers and the floats of a ray become each other: what "rounded" means in decide.h.
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <limits>

#include "scenes/geometry/ray.h"

namespace raymeter {

/// A denormal counts as zero, whether or not the thread's mode (DAZ) already reads it as zero.
inline float flushed(float x) {
  return std::abs(x) < FLT_MIN ? 0.0f : x;
}

/// The nearest float, ties to even; 0 below FLT_MIN in magnitude, infinite beyond FLT_MAX. Monotone. NaN
/// stays NaN.
inline float rounded(double t) {
  const double magnitude = std::abs(t);
  if (magnitude < double(FLT_MIN)) return 0;
  if (magnitude > double(FLT_MAX)) return t > 0 ? no_hit : -no_hit;
  return static_cast<float>(t);
}

/// The next float, of a finite one; denormals are skipped.
inline float next_above(float x) {
  if (flushed(x) == 0) return x < 0 ? 0.0f : FLT_MIN;
  const auto bits = std::bit_cast<std::int32_t>(x);
  return flushed(std::bit_cast<float>(x > 0 ? bits + 1 : bits - 1));
}
inline float next_below(float x) {
  return -next_above(-x);
}

/// The greatest float that is not above x and not denormal.
inline float float_below(double x) {
  const float nearest = rounded(x);
  return nearest > x ? next_below(nearest) : nearest;
}

/// `rounded` of a real number that is known by comparison only: `compare(m, e)` is the sign of the number
/// less m * 2^e, for integers |m| < 2^25. Bisects over the floats.
template <class Compare>
float rounded_by_comparison(const Compare& compare) {
  constexpr int mantissa_bits = 23;
  const int sign = compare(0, 0);
  if (sign == 0) return 0;
  // The magnitude against the float of the given bits plus `halves` half units in its last place.
  const auto against = [&](std::uint32_t bits, int halves) {
    const auto mantissa = static_cast<std::int32_t>((bits & 0x7fffffu) | 0x800000u);
    const auto exponent = static_cast<int>(bits >> mantissa_bits) - 127 - mantissa_bits;
    return sign * compare(sign * (2 * mantissa + halves), exponent - 1);
  };
  auto low = std::bit_cast<std::uint32_t>(FLT_MIN), high = std::bit_cast<std::uint32_t>(FLT_MAX);
  if (against(low, 0) < 0) return 0;
  if (against(high, 0) > 0) return sign > 0 ? no_hit : -no_hit;
  // The greatest float that is not above the magnitude.
  while (low < high) {
    const std::uint32_t middle = low + (high - low + 1) / 2;
    if (against(middle, 0) >= 0)
      low = middle;
    else
      high = middle - 1;
  }
  // It, or the next one.
  const int beyond_half = against(low, 1);
  if (beyond_half > 0 || (beyond_half == 0 && low % 2 == 1)) ++low;
  return std::copysign(std::bit_cast<float>(low), static_cast<float>(sign));
}

/// t when it lies in the ray's interval tnear < t <= tfar, else `no_hit`.
inline float within(const Ray& ray, float t) {
  return t > flushed(ray.tnear) && t <= flushed(ray.tfar) && t < no_hit ? t : no_hit;
}

/// An answer that is not known yet, for the double stage of `decide`: it equals no t and is not `no_hit`.
inline constexpr float undecided = std::numeric_limits<float>::quiet_NaN();

/// `within` the ray's interval of the `rounded` real number that is known to be t +- error, or `undecided`.
inline float within(const Ray& ray, double t, double error) {
  const float low = rounded(t - error), high = rounded(t + error);
  if (low == high) return within(ray, low);
  if (high <= flushed(ray.tnear) || low > flushed(ray.tfar)) return no_hit;
  return undecided;
}

}  // namespace raymeter
