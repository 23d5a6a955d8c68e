#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/ray_batch.h"
#include "harness/tracing.h"
#include "scenes/scene.h"

namespace raymeter {

/// The answers of `decide` over every primitive for every ray: filter, then decide, nothing else. Runs on all
/// CPUs.
BatchAnswers brute_force(const Scene& scene, std::span<const Ray> rays, QueryKind query);

/// The hit that `decide` gives for each primitive that the ray hits in its interval, in the order of hits.
std::vector<Hit> all_hits(const Scene& scene, const Ray& ray);

/// How well the truth about one ray is known.
enum class Basis : std::uint8_t {
  unknown,  ///< nobody exact answered it, or it was disputed when the budget had run out
  agreed,   ///< all exact rows agree, and nobody gave reason to doubt
  proved,   ///< by brute force
};

/// What is true of every ray of a batch.
struct Truth {
  BatchAnswers answers;
  std::vector<Basis> basis;      ///< of every ray; where it is `unknown`, `answers` says nothing
  std::size_t brute_forced = 0;  ///< rays that are `proved`
  std::size_t known = 0;         ///< rays that are not `unknown`
};

/// One structure's answers to a batch, as grading sees them.
struct Row {
  const BatchAnswers& answers;
  Answers policy;
};

struct TruthSettings {
  std::uint64_t seed = 1;     ///< of the sample
  std::size_t sample = 4096;  ///< rays that are proved whatever the rows say
  /// Up to this many ray-primitive tests the whole batch is proved; and the rays outside the sample that are
  /// disputed are proved until they have cost this much.
  double test_budget = 2.5e8;
};

/// The truth about a batch. Small scenes are brute-forced whole. Else the answer on which all exact rows
/// agree is taken for true, except on the rays that brute force settles: a seeded sample; every ray on which
/// two exact rows differ; and every ray on which another row contradicts them by more than the last bits of
/// t. So a fault that all exact rows share is caught where it meets the sample or a foreign row.
Truth establish_truth(const Scene& scene, const RayBatch& batch, std::span<const Row> rows,
                      const TruthSettings& settings = {});

/// Takes one more row into account: every ray on which it contradicts a truth that is only `agreed` is
/// brute-forced. Returns on how many of them the truth turned out to be another than was believed (the rows
/// that agreed on it were all wrong).
std::size_t settle_disputes(const Scene& scene, const RayBatch& batch, const Row& row, Truth& truth,
                            const TruthSettings& settings = {});

}  // namespace raymeter
