#pragma once
#include <cfloat>
#include <cmath>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// A real number known as a double and a bound on its distance from it: the same formula that is computed
/// exactly with ExactInteger is computed with this first, and tells whether that was enough. Ball arithmetic
/// with a running error bound (Higham, "Accuracy and Stability of Numerical Algorithms", 2002, section 3.3).
/// Each operation adds half an ulp for its own rounding, `tiny` for a result or an error that underflowed or
/// was flushed, and `inflation` for the rounding of the bound. What overflows becomes infinite or NaN, and
/// certain of nothing.
struct Bounded {
  double value = 0;
  double error = 0;

  static constexpr double half_ulp = 0x1p-53, tiny = 8 * DBL_MIN, inflation = 1 + 0x1p-50;

  bool certainly_positive() const { return value > error; }
  bool certainly_negative() const { return value < -error; }
  bool certainly_not_zero() const { return std::abs(value) > error; }

  /// `value`, which was rounded once, as the result of an operation on uncertain operands.
  static Bounded result(double value, double inherited) {
    return {value, (inherited + half_ulp * std::abs(value)) * inflation + tiny};
  }
  friend Bounded operator+(const Bounded& a, const Bounded& b) {
    return result(a.value + b.value, a.error + b.error);
  }
  friend Bounded operator-(const Bounded& a, const Bounded& b) {
    return result(a.value - b.value, a.error + b.error);
  }
  friend Bounded operator-(const Bounded& a) { return {-a.value, a.error}; }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    return result(a.value * b.value, (std::abs(a.value) + a.error) * b.error + std::abs(b.value) * a.error);
  }
  /// b must be certainly_not_zero.
  friend Bounded operator/(const Bounded& a, const Bounded& b) {
    const double quotient = a.value / b.value;
    return result(quotient,
                  (a.error + std::abs(quotient) * b.error) / (std::abs(b.value) - b.error) * (1 + 0x1p-40));
  }
  /// x must be certainly_positive: |sqrt(x) - sqrt(y)| = |x - y| / (sqrt(x) + sqrt(y)).
  friend Bounded sqrt(const Bounded& x) {
    const double root = std::sqrt(x.value);
    return result(root, x.error / root * (1 + 0x1p-40));
  }
};

}  // namespace raymeter
