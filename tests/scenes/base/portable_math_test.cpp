#include "scenes/base/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "scenes/base/hash.h"
#include "scenes/base/random.h"

namespace raymeter {
namespace {

/// In (0, 1), with 48 random bits.
double fine_uniform(Random& random) {
  const double high = random.bits() >> 8u, low = random.bits() >> 8u;
  return high * 0x1p-24 + (low + 0.5) * 0x1p-48;
}

/// The error of `value` in units of the last place of the exact one.
double ulps(double value, long double exact) {
  const double nearest = std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact)) /
         (std::nextafter(nearest, INFINITY) - nearest);
}

void check(const SineCosine& got, long double angle) {
  const long double sine = std::sin(angle), cosine = std::cos(angle);
  ASSERT_NEAR(got.sine, static_cast<double>(sine), 1e-15) << angle;
  ASSERT_NEAR(got.cosine, static_cast<double>(cosine), 1e-15) << angle;
  for (const auto& [value, exact] : {std::pair(got.sine, sine), std::pair(got.cosine, cosine)})
    if (std::abs(exact) > 0.01L) {
      ASSERT_LE(ulps(value, exact), 4) << angle;
    }
}

TEST(PortableMath, SineAndCosineOfRadians) {
  Random random(1);
  for (const double range : {0.5, 4.0, 100.0, 1e5})
    for (int i = 0; i < 50000; ++i) {
      const double angle = range * (2 * fine_uniform(random) - 1);
      ASSERT_NO_FATAL_FAILURE(check(sine_cosine(angle), angle));
    }
  EXPECT_EQ(sine_cosine(0).sine, 0);
  EXPECT_EQ(sine_cosine(0).cosine, 1);
  EXPECT_EQ(sine_cosine(pi / 2).sine, 1);
  EXPECT_EQ(sine_cosine(-pi / 2).sine, -1);
  EXPECT_EQ(sine_cosine(pi).cosine, -1);
}

TEST(PortableMath, SineAndCosineOfTurns) {
  constexpr long double full = 2 * 3.14159265358979323846264L;
  Random random(5);
  for (const double range : {0.1, 1.0, 1000.0})
    for (int i = 0; i < 50000; ++i) {
      const double turns = range * (2 * fine_uniform(random) - 1);
      ASSERT_NO_FATAL_FAILURE(
          check(sine_cosine_of_turns(turns), full * static_cast<long double>(turns - std::round(turns))));
    }
  const double sines[] = {0, 1, 0, -1};
  for (int quarter = -8; quarter <= 8; ++quarter) {
    EXPECT_EQ(sine_cosine_of_turns(quarter / 4.0).sine, sines[(quarter + 8) % 4]) << quarter;
    EXPECT_EQ(sine_cosine_of_turns(quarter / 4.0).cosine, sines[(quarter + 9) % 4]) << quarter;
  }
}

TEST(PortableMath, Exponential) {
  Random random(2);
  for (const double range : {1e-3, 1.0, 30.0, 706.0})
    for (int i = 0; i < 50000; ++i) {
      const double x = range * (2 * fine_uniform(random) - 1);
      ASSERT_LE(ulps(exponential(x), std::exp(static_cast<long double>(x))), 4) << x;
    }
  constexpr double near_the_limit = 709.7;
  EXPECT_LE(ulps(exponential(near_the_limit), std::exp(static_cast<long double>(near_the_limit))), 4);
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(exponential(710), INFINITY);
  EXPECT_EQ(exponential(INFINITY), INFINITY);
  EXPECT_EQ(exponential(-710), 0);
  EXPECT_EQ(exponential(-INFINITY), 0);
}

TEST(PortableMath, NaturalLog) {
  Random random(3);
  for (int i = 0; i < 200000; ++i) {
    // Of all magnitudes, and close to 1.
    double x = 0.5 + fine_uniform(random);
    if (i % 2 == 0) x = std::ldexp(x, static_cast<int>(random.below(2000)) - 1000);
    ASSERT_LE(ulps(natural_log(x), std::log(static_cast<long double>(x))), 4) << x;
  }
  EXPECT_EQ(natural_log(1), 0);
}

TEST(PortableMath, ResultsAreTheSameOnEveryMachine) {
  Hasher hasher;
  Random random(4);
  for (int i = 0; i < 10000; ++i) {
    const double x = 20 * fine_uniform(random);
    for (const auto& [sine, cosine] : {sine_cosine(x), sine_cosine_of_turns(x)}) {
      hasher.value(sine);
      hasher.value(cosine);
    }
    hasher.value(exponential(x - 10));
    hasher.value(natural_log(x));
  }
  EXPECT_EQ(hasher.digest(), 2559412448670829290u);
}

}  // namespace
}  // namespace raymeter
