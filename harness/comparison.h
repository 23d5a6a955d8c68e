#pragma once
#include <cstdint>
#include <filesystem>
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
  std::vector<Spec> structures;  ///< none: every kind of the registry but brute-force, at its defaults
  std::vector<Spec> ray_kinds;   ///< none, and no files: primary, shadow, reflection, diffuse
  std::vector<std::filesystem::path> ray_files;  ///< further batches, made for the scene (ray_file.h)
  Spec baseline{"embree", {}};
  BatchSettings batches;
  RaceSettings race;
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< bytes, for each structure
};

/// Throws Error when a structure, the baseline or a ray kind does not exist or has other parameters.
void check(const ComparisonSettings& settings, const Registry& registry);

/// Whether a record shows its structure to be at fault: it could not be built, its counted pass differs from
/// the timed one, or an answer is wrong, unexplained or, of an exact structure, not given. Of a `tolerated`
/// kind only the second is.
bool is_fault(const Record& record, const StructureKind& kind);

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
