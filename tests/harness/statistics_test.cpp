#include "harness/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

TEST(Statistics, MedianIntervalContainsTheMedianAndIsReproducible) {
  const std::vector<double> values = {1.00, 1.02, 0.97, 1.05, 0.99, 1.01, 1.20};
  const Interval interval = median_interval(values);
  EXPECT_LE(interval.low, median(values));
  EXPECT_GE(interval.high, median(values));
  EXPECT_GE(interval.low, 0.97);
  EXPECT_LE(interval.high, 1.20);
  EXPECT_LT(interval.low, interval.high);
  EXPECT_EQ(interval.low, median_interval(values).low);
  EXPECT_EQ(interval.high, median_interval(values).high);
}

TEST(Statistics, MedianIntervalOfEqualValuesIsAPoint) {
  const Interval interval = median_interval(std::vector<double>{2, 2, 2});
  EXPECT_EQ(interval.low, 2);
  EXPECT_EQ(interval.high, 2);
  EXPECT_TRUE(std::isnan(median_interval({}).low));
}

// The bootstrap distribution of the median of three values is known: the largest of them is the median of a
// resample with probability 7/27, so that the 95% interval is the whole range.
TEST(Statistics, MedianIntervalOfThreeValuesIsTheirRange) {
  const Interval interval = median_interval(std::vector<double>{3, 1, 2});
  EXPECT_EQ(interval.low, 1);
  EXPECT_EQ(interval.high, 3);
}

}  // namespace
}  // namespace raymeter
