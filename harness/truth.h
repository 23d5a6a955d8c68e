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

/// What is true of every ray of a batch.
struct Truth {
  BatchAnswers answers;
  std::vector<std::uint8_t>
      proved;  ///< by ray: 1 where brute force gave the answer, 0 where it is the reference's
  std::size_t brute_forced = 0;  ///< how many are proved
};

/// One structure's answers to a batch, as grading sees them.
struct Row {
  const BatchAnswers& answers;
  Answers policy;
};

struct TruthSettings {
  std::uint64_t seed = 1;     ///< of the sample
  std::size_t sample = 4096;  ///< rays that are proved whatever anybody says
  /// Up to this many ray-primitive tests the whole batch is proved; and the rays that one row disputes are
  /// proved until they have cost this much.
  double test_budget = 2.5e8;
};

/// The truth about a batch. Small scenes are brute-forced whole. Else the answers of `reference`, an exact
/// structure, are taken for true, except on a seeded sample of the rays, which is brute-forced.
Truth establish_truth(const Scene& scene, const RayBatch& batch, const BatchAnswers& reference,
                      const TruthSettings& settings = {});

/// Takes a row into account: rays on which it contradicts a truth that is not proved are brute-forced, as
/// many as the budget allows; the others stay as they are, since a doubt is no disproof. Differences of a
/// within_bound row in the last bits, and ties, are no contradictions. So a fault of the reference is caught
/// where it meets the sample, or any other row. Returns on how many rays the reference was refuted.
std::size_t settle_disputes(const Scene& scene, const RayBatch& batch, const Row& row, Truth& truth,
                            const TruthSettings& settings = {});

}  // namespace raymeter
