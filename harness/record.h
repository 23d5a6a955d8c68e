#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace raymeter {

/// One race of one structure against the baseline on one batch, with everything that was learned of it. What
/// could not be had is absent (an empty field), never 0. `columns()` says what each member means and in which
/// unit.
struct Record {
  using Text = std::string;
  using Count = std::optional<std::uint64_t>;
  using Number = std::optional<double>;

  Text key, scene, scene_hash, structure, spec, baseline, batch, query, order;
  Count primitives, rays, hits;
  Text ray_hash, reference_hash, hit_hash;

  Number build_s, build_low_s, build_high_s;
  Text bytes_by_part;
  Count bytes, peak_bytes, nx, ny, nz, cells, empty_cells, inner_nodes, references, depth;

  Number steps_per_ray, cell_steps_per_ray, empty_cell_steps_per_ray, tests_per_ray, test_blocks_per_ray,
      distinct_tests_per_ray, decides_per_ray, point_locations_per_ray, subgrids_entered_per_ray;
  Count steps_p50, steps_p90, steps_p99, steps_max, tests_p50, tests_p90, tests_p99, tests_max;

  Number mrays_per_s, baseline_mrays_per_s, ratio, ratio_low, ratio_high, spread;
  Text noisy, pinned;

  Count right, within_bound, tie, edge, grazing, at_limit, degenerate, wrong, not_given, unexplained,
      brute_forced;

  Text isa, build_id, environment_id;
  Count threads, rounds, seed;
  Text status, note;
};

/// A column of the records, as writers, readers, `raymeter list columns` and the documentation use it.
struct Column {
  std::string_view name;
  std::string_view unit;  ///< "" for text, "1" for a plain count or ratio
  std::string_view meaning;
  std::variant<Record::Text Record::*, Record::Count Record::*, Record::Number Record::*> member;

  /// The value as text for CSV: empty when absent, numbers in shortest exact form.
  std::string text(const Record& record) const;
};

/// All columns, in the order of records.csv.
std::span<const Column> columns();

}  // namespace raymeter
