#include "harness/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace raymeter {
namespace {

double quantile_of_sorted(std::span<const double> sorted, double q) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = position - static_cast<double>(below);
  return sorted[below] + part * (sorted[above] - sorted[below]);
}

/// The interval from the `from_end`-th smallest to the `from_end`-th largest of some values.
struct OrderStatistics {
  std::size_t from_end = 1;
  double confidence = 0;  ///< that it contains the median of what the values are drawn from
};

OrderStatistics median_order_statistics(std::size_t count) {
  const auto n = static_cast<double>(count);
  OrderStatistics best;
  // The interval misses the median where fewer than `from_end` of the values lie on one of its sides: the two
  // tails of a binomial distribution. Moving inwards by one value adds one of its terms to each tail.
  double tail = 0, log_term = -n * std::log(2.0);
  for (std::size_t from_end = 1; 2 * from_end <= count + 1; ++from_end) {
    tail += std::exp(log_term);
    const double confidence = std::max(0.0, 1 - 2 * tail);
    if (from_end > 1 && confidence < 0.95) break;
    best = {from_end, confidence};
    const auto k = static_cast<double>(from_end);
    log_term += std::log((n - k + 1) / k);
  }
  return best;
}

}  // namespace

double quantile(std::span<const double> values, double q) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return quantile_of_sorted(sorted, q);
}

double median(std::span<const double> values) {
  return quantile(values, 0.5);
}

double relative_spread(std::span<const double> values) {
  return (quantile(values, 0.75) - quantile(values, 0.25)) / median(values);
}

Interval median_interval(std::span<const double> values) {
  if (values.empty()) return {quantile(values, 0), quantile(values, 1)};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t from_end = median_order_statistics(sorted.size()).from_end;
  return {sorted[from_end - 1], sorted[sorted.size() - from_end]};
}

double median_interval_confidence(std::size_t count) {
  return count == 0 ? 0 : median_order_statistics(count).confidence;
}

}  // namespace raymeter
