#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "accel/registry.h"
#include "harness/judged_batches.h"
#include "harness/race.h"
#include "harness/ray_batch.h"
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

/// The structures that the settings name, or the default ones.
std::vector<Spec> structures_of(const ComparisonSettings& settings, const Registry& registry);
/// The kinds of rays that they name, or the default ones.
std::vector<Arguments> ray_kinds_of(const ComparisonSettings& settings);

/// The scene's batches: of each of ray_kinds_of, then of each ray file. Throws Error as BatchJudge and
/// read_ray_file do; a file that can't be used costs nothing.
std::vector<BatchGroup> make_batches(const Scene& scene, const Registry& registry,
                                     const ComparisonSettings& settings, const ReferenceRefuted& refuted);

}  // namespace raymeter
