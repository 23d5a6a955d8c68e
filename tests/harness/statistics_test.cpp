#include "harness/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenes/base/random.h"

namespace raymeter {
namespace {

TEST(Statistics, QuantilesInterpolateBetweenOrderStatistics) {
  const std::vector<double> values = {4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(quantile(values, 0), 1);
  EXPECT_DOUBLE_EQ(quantile(values, 1), 4);
  EXPECT_DOUBLE_EQ(quantile(values, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(median(values), 2.5);
  EXPECT_DOUBLE_EQ(median(std::vector<double>{9, 1, 5}), 5);
  EXPECT_DOUBLE_EQ(relative_spread(std::vector<double>{1, 2, 3, 4, 5}), 2.0 / 3);
  EXPECT_DOUBLE_EQ(relative_spread(std::vector<double>{7}), 0);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, MedianIntervalIsTheWholeRangeOfUpToEightValues) {
  for (std::size_t count = 1; count <= 8; ++count) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<double>((i * 5 + 3) % count));
    if (count == 5) values = {3, 0, 4, 1, 2};
    const Interval interval = median_interval(values);
    EXPECT_EQ(interval.low, 0) << count;
    EXPECT_EQ(interval.high, static_cast<double>(count - 1)) << count;
    EXPECT_NEAR(median_interval_confidence(count), 1 - std::exp2(1 - static_cast<double>(count)), 1e-12);
  }
  EXPECT_TRUE(std::isnan(median_interval({}).low));
  EXPECT_TRUE(std::isnan(median_interval({}).high));
  EXPECT_EQ(median_interval_confidence(0), 0);
}

// From published tables of the binomial distribution with p = 1/2.
TEST(Statistics, MedianIntervalOfMoreValuesLeavesOutTheOutermost) {
  struct Expected {
    std::size_t count, from_end;
    double confidence;
  };
  for (const auto& [count, from_end, confidence] :
       {Expected{9, 2, 0.9609}, Expected{10, 2, 0.9785}, Expected{11, 2, 0.9883}, Expected{12, 3, 0.9614},
        Expected{15, 4, 0.9648}, Expected{20, 6, 0.9586}, Expected{25, 8, 0.9567}}) {
    SCOPED_TRACE(count);
    std::vector<double> values;
    for (std::size_t i = count; i > 0; --i) values.push_back(static_cast<double>(i));
    const Interval interval = median_interval(values);
    EXPECT_EQ(interval.low, static_cast<double>(from_end));
    EXPECT_EQ(interval.high, static_cast<double>(count + 1 - from_end));
    EXPECT_NEAR(median_interval_confidence(count), confidence, 5e-5);
  }
  EXPECT_GE(median_interval_confidence(10000), 0.95) << "2^-10000 is no double";
  EXPECT_LE(median_interval_confidence(10000), 0.952);
}

// What confidence means: how often the interval of a skewed sample holds the median it was drawn from.
TEST(Statistics, MedianIntervalCoversAsOftenAsItSays) {
  Random random(7);
  for (const std::size_t count : {3u, 5u, 6u, 20u}) {
    constexpr int samples = 20000;
    int covered = 0;
    std::vector<double> values(count);
    for (int i = 0; i < samples; ++i) {
      for (double& value : values) value = std::exp(4 * double(random.uniform()));  // median e^2
      const Interval interval = median_interval(values);
      covered += interval.low <= std::exp(2.0) && std::exp(2.0) <= interval.high;
    }
    EXPECT_NEAR(double(covered) / samples, median_interval_confidence(count), 0.012) << count;
  }
}

}  // namespace
}  // namespace raymeter
