#pragma once
#include <cstdint>

#include "harness/counters.h"
#include "harness/grading.h"
#include "harness/judged_batches.h"
#include "harness/truth.h"

namespace raymeter {

/// What one structure's answers to one batch turned out to be.
struct CheckedAnswers {
  CounterTotals counters;  ///< of a counted pass; of no rays where the structure can't count
  Grades grades;
  std::uint64_t hits = 0, hit_hash = 0;
  bool consistent = true;  ///< the counted pass gave the same answers
};

/// Counts and grades what the structure, to which the batch was given by `prepare`, answered. Disputed rays
/// are settled first, and the truth of the batch with them: `refuted` is told where it changes.
CheckedAnswers check_answers(const Scene& scene, const Structure& structure, const Row& row,
                             JudgedBatch& batch, const ReferenceRefuted& refuted);

}  // namespace raymeter
