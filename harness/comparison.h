#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/race.h"
#include "harness/ray_batch.h"
#include "harness/record.h"
#include "scenes/base/spec.h"
#include "scenes/scene.h"

namespace raymeter {

/// What to compare on each scene.
struct ComparisonSettings {
  std::vector<Spec> structures;
  std::vector<Spec> ray_kinds;
  Spec baseline;
  BatchSettings batches;
  RaceSettings race;
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< bytes, for each structure
};

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
/// becomes records that say why; the others go on. Throws Error for specs that don't exist, before anything
/// is measured.
void compare_structures(const Scene& scene, const Registry& registry, const ComparisonSettings& settings,
                        ComparisonObserver& observer);

}  // namespace raymeter
