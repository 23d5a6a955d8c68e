#include "harness/counters.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace raymeter {

std::uint32_t Histogram::bucket_of(std::uint32_t value) {
  if (value < exact) return value;
  // The top six bits of the value name its bucket within its octave: 32 .. 63.
  const auto shift = static_cast<std::uint32_t>(std::bit_width(value)) - 6;
  return exact + (shift - 1) * per_octave + ((value >> shift) - per_octave);
}

std::uint32_t Histogram::highest_of(std::uint32_t bucket) {
  if (bucket < exact) return bucket;
  const std::uint32_t shift = (bucket - exact) / per_octave + 1;
  const std::uint64_t top = (bucket - exact) % per_octave + per_octave;
  return static_cast<std::uint32_t>(((top + 1) << shift) - 1);
}

void Histogram::add(std::uint32_t value) {
  ++buckets_[bucket_of(value)];
  ++count_;
  maximum_ = std::max(maximum_, value);
}

void Histogram::add(const Histogram& other) {
  for (std::size_t i = 0; i < buckets_.size(); ++i) buckets_[i] += other.buckets_[i];
  count_ += other.count_;
  maximum_ = std::max(maximum_, other.maximum_);
}

std::uint32_t Histogram::percentile(double fraction) const {
  const double wanted = std::ceil(fraction * static_cast<double>(count_));
  std::uint64_t seen = 0;
  for (std::uint32_t i = 0; i < buckets_.size(); ++i) {
    seen += buckets_[i];
    if (seen > 0 && static_cast<double>(seen) >= wanted) return std::min(highest_of(i), maximum_);
  }
  return maximum_;
}

void CounterTotals::add(std::span<const RayCounters> counters) {
  rays += counters.size();
  for (const RayCounters& ray : counters) {
    steps += ray.steps;
    cell_steps += ray.cell_steps;
    empty_cell_steps += ray.empty_cell_steps;
    tests += ray.tests;
    test_blocks += ray.test_blocks;
    distinct_tests += ray.distinct_tests;
    decides += ray.decides;
    point_locations += ray.point_locations;
    subgrids_entered += ray.subgrids_entered;
    steps_histogram.add(ray.steps);
    tests_histogram.add(ray.tests);
  }
}

void CounterTotals::add(const CounterTotals& other) {
  rays += other.rays;
  steps += other.steps;
  cell_steps += other.cell_steps;
  empty_cell_steps += other.empty_cell_steps;
  tests += other.tests;
  test_blocks += other.test_blocks;
  distinct_tests += other.distinct_tests;
  decides += other.decides;
  point_locations += other.point_locations;
  subgrids_entered += other.subgrids_entered;
  steps_histogram.add(other.steps_histogram);
  tests_histogram.add(other.tests_histogram);
}

}  // namespace raymeter
