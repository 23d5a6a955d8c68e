#include "harness/checked_answers.h"

#include "harness/tracing.h"

namespace raymeter {

CheckedAnswers check_answers(const Scene& scene, const Structure& structure, const Row& row,
                             JudgedBatch& batch, const ReferenceRefuted& refuted) {
  CheckedAnswers checked;
  checked.hits = count_hits(row.answers);
  checked.hit_hash = hit_hash(row.answers);
  if (structure.counts()) {
    BatchAnswers counted;
    checked.counters = count(structure, batch.rays.view(), counted, all_cpus());
    checked.consistent = counted == row.answers;
  }
  if (const std::size_t rays = settle_disputes(scene, batch.rays, row, batch.truth))
    refuted(batch.rays.name, rays);
  checked.grades = grade(scene, batch.rays, batch.truth, row);
  return checked;
}

}  // namespace raymeter
