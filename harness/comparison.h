#pragma once
#include <cstddef>
#include <string_view>

#include "accel/registry.h"
#include "harness/comparison_settings.h"
#include "harness/grading.h"
#include "harness/record.h"
#include "scenes/scene.h"

namespace raymeter {

/// Whether a record shows its structure to be at fault: it could not be built, its counted pass differs from
/// the timed one, or an answer is wrong, unexplained or, of an exact structure, not given. Of a `tolerated`
/// kind only the second is.
bool is_fault(const Record& record, const StructureKind& kind);
/// The same of answers alone.
bool is_fault(const Grades& grades, const StructureKind& kind);

/// Is told of everything that happens during a comparison.
class ComparisonObserver {
 public:
  virtual ~ComparisonObserver() = default;
  /// The record of this key from an earlier, killed run; nullptr to measure it now.
  virtual const Record* finished(std::string_view /*key*/) { return nullptr; }
  /// A row is done (or was taken from `finished`). Rows come structure by structure, batch by batch.
  virtual void record(const Record& record) = 0;
  virtual void progress(std::size_t /*done*/, std::size_t /*total*/, std::string_view /*doing*/) {}
  /// The answers from which the truth was taken were refuted by brute force on `rays` rays: a fault of ours.
  /// Rows of this batch that were recorded earlier share it.
  virtual void reference_refuted(std::string_view batch, std::size_t rays) = 0;
};

/// Compares the structures on one scene, on identical batches, and hands a record for each structure and
/// batch to the observer, as soon as it is known. The baseline gets rows of its own (raced against itself:
/// the floor of the method), whether it is among the structures or not. A structure that can't be built
/// becomes records that say why; the others go on. Throws Error as `check` does, and for ray files that are
/// damaged or of another scene, before anything is measured.
void compare_structures(const Scene& scene, const Registry& registry, const ComparisonSettings& settings,
                        ComparisonObserver& observer);

}  // namespace raymeter
