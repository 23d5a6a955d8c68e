#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "accel/structure.h"
#include "harness/ray_batch.h"
#include "harness/statistics.h"
#include "harness/tracing.h"

namespace raymeter {

struct RaceSettings {
  unsigned rounds = 5;
  unsigned threads = 1;
  /// A side whose pass is shorter repeats it until its part of a round lasts as long as this.
  double min_round_seconds = 0.02;
  /// Wall-clock seconds after which no further round begins. Three rounds are always run (or `rounds`, if
  /// fewer); but of a structure that takes more than a second for one pass only as many as fit, and one at
  /// least.
  double time_budget = std::numeric_limits<double>::infinity();
};

/// One runner's part in a race.
struct RaceSide {
  std::vector<double> rays_per_second;  ///< of every round
  double median_rays_per_second = 0;
  unsigned repetitions = 1;  ///< passes over the batch in each round
  BatchAnswers answers;      ///< of the last timed pass
};

struct RaceResult {
  RaceSide baseline, structure;
  std::vector<double> ratios;  ///< by round: throughput of the structure over the baseline's
  double ratio = 0;            ///< their median
  Interval ratio_interval;     ///< of that median; see median_interval_confidence(rounds())
  double spread = 0;           ///< interquartile range of the ratios over their median
  bool noisy = false;          ///< the spread exceeds `noisy_spread`
  bool pinned = false;         ///< the tracing thread was held on one CPU
  unsigned threads = 1;        ///< one: CPU time was measured; more: wall time
  unsigned rounds() const { return static_cast<unsigned>(ratios.size()); }
};

/// A race whose per-round ratios have a relative interquartile range above this is marked noisy.
inline constexpr double noisy_spread = 0.05;

/// Races `structure` against `baseline` on the same rays, round by round: in every round both trace the batch
/// one after the other, and who begins alternates, so that a drift of the machine's speed hurts both alike
/// and cancels in the ratio of the round. A warm-up is traced and discarded, unless one pass of the structure
/// takes more than a second: then it is the first round. Both are given the batch by `prepare` first,
/// untimed. `baseline` and `structure` may be one object: such an A/A race shows the floor of the method. A
/// batch without rays gives a result without rounds, its numbers NaN.
RaceResult race(Structure& baseline, Structure& structure, const RayBatch& batch,
                const RaceSettings& settings);

/// The race over several batches, of rays[i] rays in races[i], one after the other: round k took as long as
/// the rounds k of all races together. As many rounds as all of them have; batches without rays are left out.
/// The repetitions and answers are not summed.
RaceResult sum_of_races(std::span<const RaceResult> races, std::span<const std::size_t> rays);

}  // namespace raymeter
