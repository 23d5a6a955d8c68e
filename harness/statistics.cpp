#include "harness/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/base/random.h"

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
  constexpr int resamples = 2000;
  constexpr std::uint64_t seed = 1979;
  Random random(seed);
  const auto count = static_cast<std::uint32_t>(values.size());
  std::vector<double> medians, sample(count);
  for (int i = 0; i < resamples; ++i) {
    for (double& value : sample) value = values[random.below(count)];
    medians.push_back(median(sample));
  }
  return {quantile(medians, 0.025), quantile(medians, 0.975)};
}

}  // namespace raymeter
