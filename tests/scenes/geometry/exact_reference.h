#pragma once
// What decide.h promises, computed the slow way: all integers, other formulas, no bounds. Shares no code with
// `decide`. Must be called with denormals on.
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cfloat>
#include <cmath>
#include <utility>
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

/// P t^2 + Q t + R = 0, solved: a root is an integer fraction, or lies between two that are made to agree in
/// all that is asked of it.
class Roots {
 public:
  Roots(Integer p, Integer q, Integer r) : p_(std::move(p)), q_(std::move(q)), r_(std::move(r)) {}

  /// The least float in the ray's interval among the roots t = n / m for which keep(n, m) holds.
  template <class Keep>
  float least(const Ray& ray, const Keep& keep) const {
    if (p_ == 0) {
      if (q_ == 0) return no_hit;
      return keep(-r_, q_) ? in_interval(ray, round_fraction(-r_, q_)) : no_hit;
    }
    const Integer discriminant = q_ * q_ - 4 * p_ * r_;
    if (discriminant < 0) return no_hit;
    float best = no_hit;
    for (const int sign : {-1, 1}) {
      for (int bits = 0;; bits += 50) {
        Integer rest;
        const Integer root = sqrt(Integer(discriminant << (2 * bits)), rest);
        const Integer denominator = (2 * p_) << bits, low = -(q_ << bits) + sign * root;
        const Integer high = rest == 0 ? low : Integer(low + sign);
        const float t = round_fraction(low, denominator);
        const bool kept = keep(low, denominator);
        if (t != round_fraction(high, denominator) || kept != keep(high, denominator)) continue;
        if (kept) best = std::min(best, in_interval(ray, t));
        break;
      }
    }
    return best;
  }

 private:
  Integer p_, q_, r_;
};

/// From the squared distance to the axis as a polynomial in t.
inline float decide(const Ray& ray, const Quadric& quadric) {
  if (!can_hit(ray) || !finite(quadric.base) || !finite(quadric.apex) ||
      !std::isfinite(quadric.base_radius) || !std::isfinite(quadric.apex_radius))
    return no_hit;
  Point o = units(ray.origin), d = units(ray.direction), base = units(quadric.base),
        apex = units(quadric.apex);
  Integer r0 = units(quadric.base_radius), r1 = units(quadric.apex_radius);
  // In the largest unit that will do: integer square roots are slow.
  unsigned spare = 1000;
  const auto each = [&](const auto& visit) {
    for (Point* v : {&o, &d, &base, &apex}) visit(v->x), visit(v->y), visit(v->z);
    visit(r0), visit(r1);
  };
  each([&](const Integer& x) {
    if (x != 0) spare = std::min(spare, static_cast<unsigned>(lsb(abs(x))));
  });
  each([&](Integer& x) { x = x < 0 ? -Integer(-x >> spare) : Integer(x >> spare); });

  const Point w = o - base;
  const Integer square[3] = {dot(w, w), 2 * dot(w, d), dot(d, d)};
  if (quadric.kind == QuadricKind::sphere)
    return Roots(square[2], square[1], square[0] - r0 * r0).least(ray, [](auto&&...) { return true; });
  const Point axis = apex - base;
  const Integer l = dot(axis, axis), height[2] = {dot(w, axis), dot(d, axis)};
  const Integer radius[2] = {l * r0 + (r1 - r0) * height[0], (r1 - r0) * height[1]};
  const auto coefficient = [&](int i) {
    const auto product = [i](const Integer* x) -> Integer {
      return i == 0 ? Integer(x[0] * x[0]) : i == 1 ? Integer(2 * x[0] * x[1]) : Integer(x[1] * x[1]);
    };
    return Integer(l * l * square[i] - l * product(height) - product(radius));
  };
  return Roots(coefficient(2), coefficient(1), coefficient(0)).least(ray, [&](Integer n, Integer m) {
    if (m < 0) n = -n, m = -m;
    const Integer h = height[0] * m + height[1] * n;
    return h >= 0 && h <= l * m;
  });
}

/// From the polynomial's values at three points of the line.
inline float decide(const Ray& ray, const GeneralQuadric& quadric) {
  const Bounds& clip = quadric.clip;
  if (!can_hit(ray) || !finite(quadric.centre) || !finite(clip.low) || !finite(clip.high)) return no_hit;
  for (const float x : quadric.coefficients)
    if (!std::isfinite(x)) return no_hit;
  Point o = units(ray.origin), d = units(ray.direction), centre = units(quadric.centre),
        low = units(clip.low), high = units(clip.high);
  Integer one = units(1.0f);
  Integer q[10];
  for (int i = 0; i < 10; ++i) q[i] = units(quadric.coefficients[static_cast<std::size_t>(i)]);
  // In the largest units that will do, as above.
  const auto shrink = [](const std::vector<Integer*>& numbers) {
    unsigned spare = 1000;
    for (const Integer* x : numbers)
      if (*x != 0) spare = std::min(spare, static_cast<unsigned>(lsb(abs(*x))));
    for (Integer* x : numbers) *x = *x < 0 ? -Integer(-*x >> spare) : Integer(*x >> spare);
  };
  std::vector<Integer*> lengths{&one}, coefficients;
  for (Point* v : {&o, &d, &centre, &low, &high})
    for (int axis = 0; axis < 3; ++axis) lengths.push_back(&(*v)[axis]);
  for (Integer& x : q) coefficients.push_back(&x);
  shrink(lengths), shrink(coefficients);

  const auto value = [&](const Point& p) -> Integer {
    const Integer terms[] = {p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.y * p.z,
                             p.z * p.x, p.x * one, p.y * one, p.z * one, one * one};
    Integer sum = 0;
    for (int i = 0; i < 10; ++i) sum += q[i] * terms[i];
    return sum;
  };
  const Integer before = value(o - centre - d), here = value(o - centre), after = value(o - centre + d);
  return Roots(before + after - 2 * here, after - before, 2 * here).least(ray, [&](Integer n, Integer m) {
    if (m < 0) n = -n, m = -m;
    for (int axis = 0; axis < 3; ++axis) {
      const Integer place = o[axis] * m + d[axis] * n;
      if (place < low[axis] * m || place > high[axis] * m) return false;
    }
    return true;
  });
}

}  // namespace raymeter::reference
