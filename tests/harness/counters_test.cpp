#include "harness/counters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes/base/random.h"

namespace raymeter {
namespace {

TEST(Histogram, IsExactForSmallValues) {
  Histogram histogram;
  for (std::uint32_t value = 0; value < 50; ++value) histogram.add(value);
  EXPECT_EQ(histogram.count(), 50u);
  EXPECT_EQ(histogram.percentile(0.5), 24u);
  EXPECT_EQ(histogram.percentile(0.9), 44u);
  EXPECT_EQ(histogram.percentile(0), 0u);
  EXPECT_EQ(histogram.percentile(1), 49u);
  EXPECT_EQ(histogram.maximum(), 49u);
}

TEST(Histogram, IsWithinOneThirtySecondForLargeOnes) {
  Random random(7);
  Histogram histogram;
  std::vector<std::uint32_t> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(random.bits() >> random.below(32));
    histogram.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double fraction : {0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size()))) - 1;
    const double exact = values[rank], found = histogram.percentile(fraction);
    EXPECT_GE(found, exact) << fraction;
    EXPECT_LE(found, exact * (1 + 1.0 / 32)) << fraction;
  }
  EXPECT_EQ(histogram.maximum(), values.back());
}

TEST(Histogram, HoldsEveryPowerOfTwoAndTheLargestValue) {
  for (std::uint32_t bit = 0; bit < 32; ++bit)
    for (const std::uint32_t value : {1u << bit, (1u << bit) - 1}) {
      Histogram histogram;
      histogram.add(value);
      EXPECT_EQ(histogram.percentile(0.5), value);
    }
  Histogram histogram;
  histogram.add(0xffffffffu);
  histogram.add(0xffffffffu);
  EXPECT_EQ(histogram.percentile(0.5), 0xffffffffu);
}

TEST(Histogram, OfNothingIsZero) {
  EXPECT_EQ(Histogram().percentile(0.5), 0u);
}

TEST(CounterTotals, SumEveryCounterOfEveryRay) {
  std::vector<RayCounters> rays(3);
  std::uint32_t next = 1;
  for (RayCounters& ray : rays) {
    ray.steps = next++;
    ray.cell_steps = next++;
    ray.empty_cell_steps = next++;
    ray.tests = next++;
    ray.test_blocks = next++;
    ray.distinct_tests = next++;
    ray.decides = next++;
    ray.point_locations = next++;
    ray.subgrids_entered = next++;
  }
  CounterTotals one, totals;
  one.add(std::span(rays).first(1));
  totals.add(std::span(rays).last(2));
  totals.add(one);
  // The i-th counter of the three rays is i, i + 9 and i + 18.
  EXPECT_EQ(totals.rays, 3u);
  EXPECT_EQ(totals.steps, 3 * 1u + 27);
  EXPECT_EQ(totals.cell_steps, 3 * 2u + 27);
  EXPECT_EQ(totals.empty_cell_steps, 3 * 3u + 27);
  EXPECT_EQ(totals.tests, 3 * 4u + 27);
  EXPECT_EQ(totals.test_blocks, 3 * 5u + 27);
  EXPECT_EQ(totals.distinct_tests, 3 * 6u + 27);
  EXPECT_EQ(totals.decides, 3 * 7u + 27);
  EXPECT_EQ(totals.point_locations, 3 * 8u + 27);
  EXPECT_EQ(totals.subgrids_entered, 3 * 9u + 27);
  EXPECT_EQ(totals.per_ray(totals.steps), 10);
  EXPECT_EQ(totals.steps_histogram.percentile(0.5), 10u);
  EXPECT_EQ(totals.tests_histogram.maximum(), 22u);
  EXPECT_EQ(CounterTotals().per_ray(0), 0);
}

}  // namespace
}  // namespace raymeter
