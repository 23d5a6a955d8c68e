#pragma once
// Exact arithmetic on the floats of rays and primitives, for the rare cases in which double can't decide.
#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// An integer of any size; up to 1024 bits (every determinant of an ordinary scene) it allocates nothing.
using ExactInteger = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<1024>,
                                                   boost::multiprecision::et_off>;

inline int sign_of(const ExactInteger& x) {
  return x.sign();
}

/// Turns floats into integers in units of one power of two, so small that all of them are integers.
/// Denormals become zero. The floats must be finite.
class ExactUnit {
 public:
  /// Takes note of floats that will be converted.
  void admit(float x) {
    const Parts parts(x);
    if (parts.mantissa != 0) exponent_ = std::min(exponent_, parts.exponent);
  }
  void admit(const Vec3& v) {
    admit(v.x);
    admit(v.y);
    admit(v.z);
  }

  ExactInteger operator()(float x) const {
    const Parts parts(x);
    if (parts.mantissa == 0) return 0;
    return ExactInteger(parts.mantissa) << (parts.exponent - exponent_);
  }
  Vector3<ExactInteger> operator()(const Vec3& v) const { return {(*this)(v.x), (*this)(v.y), (*this)(v.z)}; }

 private:
  /// x = mantissa * 2^exponent, the mantissa odd or 0.
  struct Parts {
    explicit Parts(float x) {
      const auto bits = std::bit_cast<std::uint32_t>(x);
      const auto biased = static_cast<int>((bits >> 23u) & 0xffu);
      if (biased == 0) return;
      const std::uint32_t whole = (bits & 0x7fffffu) | 0x800000u;
      const int zeros = std::countr_zero(whole);
      mantissa = static_cast<std::int32_t>(whole >> zeros);
      if (bits >> 31u) mantissa = -mantissa;
      exponent = biased - 127 - 23 + zeros;
    }
    std::int32_t mantissa = 0;
    int exponent = 0;
  };

  int exponent_ = std::numeric_limits<int>::max();
};

/// m * 2^e as a fraction of integers, the denominator positive.
struct ExactFraction {
  ExactInteger numerator;
  ExactInteger denominator;

  ExactFraction(const ExactInteger& n, const ExactInteger& d) : numerator(n), denominator(d) {}
  ExactFraction(std::int32_t m, int e) : numerator(m), denominator(1) {
    if (e >= 0)
      numerator <<= e;
    else
      denominator <<= -e;
  }
};

}  // namespace raymeter
