#pragma once
#include <cstddef>
#include <span>

namespace raymeter {

/// The q-quantile (0..1) of the values, interpolated linearly between order statistics (Hyndman & Fan 1996,
/// definition 7). NaN when there are none.
double quantile(std::span<const double> values, double q);

double median(std::span<const double> values);

/// Interquartile range over median: how widely the values spread. NaN when there are none.
double relative_spread(std::span<const double> values);

struct Interval {
  double low = 0, high = 0;
};

/// A confidence interval of the median that supposes nothing about the distribution of the values, only that
/// they are independent (Conover, "Practical Nonparametric Statistics", 3rd ed. 1999, section 3.2): from the
/// k-th smallest to the k-th largest value, with the largest k that leaves at least 95% confidence. Five
/// values or fewer can't give that much: then it is their whole range. NaN when there are none.
Interval median_interval(std::span<const double> values);

/// The confidence that median_interval attains with `count` values, 0..1: 0.75 with 3, 0.9375 with 5,
/// 0.96875 with 6.
double median_interval_confidence(std::size_t count);

}  // namespace raymeter
