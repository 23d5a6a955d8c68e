#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "accel/registry.h"
#include "harness/record.h"
#include "reports/record_files.h"

namespace raymeter {

/// What of a race changed between two runs.
struct Change {
  enum class Kind : unsigned char { worse, better, other };
  Kind kind = Kind::other;
  std::string race;  ///< scene, structure, rays: as tables name them
  std::string what;  ///< "steps_per_ray 20.5 -> 21 (+2.4%)"
};

struct RecordDiff {
  std::vector<Change> changes;
  std::size_t compared = 0;    ///< races that both runs have
  bool times_compared = true;  ///< both ran on processors of the same name

  bool worse() const;
};

/// Compares the races that two runs share: same scene, structure, rays, baseline and settings. Counters,
/// bytes, grades and hashes exactly. Ratios by their intervals, which must lie apart, and the ratios by more
/// than `tolerance` (0.1: 10%) and than the baseline strays from itself in either run: intervals know nothing
/// of what differs from process to process, as the places of things in memory. Build times where their ranges
/// lie apart by more than four times the tolerance, since nothing runs beside them that would cancel the
/// machine's moods. A race that is missing or whose rays differ counts as worse: nobody can vouch for it.
RecordDiff diff_records(std::span<const Record> before, std::span<const Record> after,
                        const Environments& environments, const Registry& registry, double tolerance);

/// The changes as text: what got worse first.
std::string diff_text(const RecordDiff& diff);

}  // namespace raymeter
