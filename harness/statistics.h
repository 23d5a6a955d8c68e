#pragma once
#include <cstdint>
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

/// The 95% bootstrap percentile interval of the median (Efron 1979), from 2000 resamples drawn by our own
/// generator with a fixed seed: the same values always give the same interval. NaN when there are none.
Interval median_interval(std::span<const double> values);

}  // namespace raymeter
