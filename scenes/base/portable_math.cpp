#include "scenes/base/portable_math.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace raymeter {
namespace {

// The mantissas of the high parts are so short that their products with an int are exact (Cody and Waite,
// "Software Manual for the Elementary Functions", 1980).
constexpr double half_pi_high = 0x1.921fb544p+0, half_pi_low = 0x1.0b4611a626331p-34;
constexpr double log_2_high = 0x1.62e42fefap-1, log_2_low = 0x1.cf79abc9e3b3ap-40;

/// x^first / first! - x^(first + 2) / (first + 2)! + ... for |x| <= pi / 4, by Horner's rule: what is left
/// out is below 1e-19.
double alternating_series(double x, int first) {
  constexpr int last = 20;
  double sum = 1;
  for (int n = last + first; n > first; n -= 2) sum = 1 - x * x / (n * (n - 1.0)) * sum;
  return first == 1 ? x * sum : sum;
}

/// Of `quarters`, a whole number of quarter turns, and `rest` radians beyond them, |rest| <= pi / 4.
SineCosine beyond_quarters(double quarters, double rest) {
  const double sine = alternating_series(rest, 1), cosine = alternating_series(rest, 0);
  switch (static_cast<std::int64_t>(quarters) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// 2^exponent for a normal result.
double power_of_two(std::int64_t exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52u);
}

}  // namespace

SineCosine sine_cosine(double angle) {
  const double quarters = std::floor(angle / (pi / 2) + 0.5);
  return beyond_quarters(quarters, (angle - quarters * half_pi_high) - quarters * half_pi_low);
}

SineCosine sine_cosine_of_turns(double turns) {
  const double quarters = std::floor(4 * turns + 0.5);
  return beyond_quarters(quarters, (4 * turns - quarters) * (pi / 2));
}

double exponential(double x) {
  constexpr double largest = 709.78, smallest = -706.8;
  if (x > largest) return std::numeric_limits<double>::infinity();
  if (x < smallest) return 0;
  // 2^doublings e^rest, |rest| <= log(2) / 2: the terms left out of the series are below 1e-19.
  const double doublings = std::floor(x / (log_2_high + log_2_low) + 0.5);
  const double rest = (x - doublings * log_2_high) - doublings * log_2_low;
  double sum = 1;
  for (int n = 16; n > 0; --n) sum = 1 + rest / n * sum;
  // In two steps, as 2^1024 is none.
  const auto exponent = static_cast<std::int64_t>(doublings), half = exponent / 2;
  return sum * power_of_two(half) * power_of_two(exponent - half);
}

double natural_log(double x) {
  // x = 2^exponent m with m in [sqrt(1/2), sqrt(2)); log(m) = 2 atanh((m - 1) / (m + 1)).
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<std::int64_t>(bits >> 52u) - 1023;
  double m = std::bit_cast<double>((bits & 0xfffffffffffffu) | 0x3ff0000000000000u);
  if (m > 1.41421356) {
    m *= 0.5;
    ++exponent;
  }
  const double s = (m - 1) / (m + 1), square = s * s;
  double sum = 0;
  for (int n = 25; n >= 3; n -= 2) sum = square * (1.0 / n + sum);
  const auto powers = static_cast<double>(exponent);
  return powers * log_2_high + (2 * (s + s * sum) + powers * log_2_low);
}

}  // namespace raymeter
