#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "accel/probe.h"

namespace raymeter {

/// How often each value occurred, in bounded memory: values below 64 exactly, larger ones in 32 buckets to
/// the octave, so that a percentile is at most 1/32 too high (Tene's HdrHistogram, 2012). 10^8 rays need no
/// 10^8 counters.
class Histogram {
 public:
  void add(std::uint32_t value);
  void add(const Histogram& other);

  std::uint64_t count() const { return count_; }
  std::uint32_t maximum() const { return maximum_; }  ///< exact; 0 when empty
  /// The least value that at least `fraction` of all values do not exceed, as the highest value of its bucket
  /// (never above the maximum). 0 when empty.
  std::uint32_t percentile(double fraction) const;

 private:
  static constexpr std::uint32_t exact = 64, per_octave = 32;
  static std::uint32_t bucket_of(std::uint32_t value);
  static std::uint32_t highest_of(std::uint32_t bucket);

  std::array<std::uint64_t, exact + per_octave * 26> buckets_{};
  std::uint64_t count_ = 0;
  std::uint32_t maximum_ = 0;
};

/// The counters of many rays together. The sums have the names and meanings of RayCounters.
struct CounterTotals {
  std::uint64_t rays = 0;
  std::uint64_t steps = 0;
  std::uint64_t cell_steps = 0;
  std::uint64_t empty_cell_steps = 0;
  std::uint64_t tests = 0;
  std::uint64_t test_blocks = 0;
  std::uint64_t distinct_tests = 0;
  std::uint64_t decides = 0;
  std::uint64_t point_locations = 0;
  std::uint64_t subgrids_entered = 0;
  Histogram steps_histogram, tests_histogram;

  void add(std::span<const RayCounters> counters);
  void add(const CounterTotals& other);
  /// A sum divided by the rays; 0 when there are none.
  double per_ray(std::uint64_t sum) const {
    return rays ? static_cast<double>(sum) / static_cast<double>(rays) : 0;
  }
};

}  // namespace raymeter
