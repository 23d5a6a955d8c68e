#include "harness/record.h"

#include <fmt/format.h>

#include <vector>

namespace raymeter {

std::string Column::text(const Record& record) const {
  return std::visit(
      [&](auto pointer) -> std::string {
        const auto& value = record.*pointer;
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Record::Text>)
          return value;
        else
          return value ? fmt::format("{}", *value) : "";
      },
      member);
}

std::span<const Column> columns() {
  using R = Record;
  static const std::vector<Column> table{
      {"scene", "", "file name, or canonical spec of a generated scene", &R::scene},
      {"scene_hash", "", "64-bit hash of geometry, materials, lights and camera", &R::scene_hash},
      {"structure", "", "name of the structure", &R::structure},
      {"spec", "", "canonical spec: every parameter written out", &R::spec},
      {"batch", "",
       "canonical spec of the ray kind; of whitted a row for each generation, and for all one after the "
       "other",
       &R::batch},
      {"rays", "1", "rays in the batch", &R::rays},
      {"hits", "1", "rays that hit, by this structure's timed answers", &R::hits},
      {"ray_hash", "", "64-bit hash of the rays, in order", &R::ray_hash},
      {"reference_hash", "", "64-bit hash of the true answers", &R::reference_hash},
      {"hit_hash", "", "64-bit hash of this row's answers, from the timed pass", &R::hit_hash},
      {"build_s", "s", "median build time of up to five builds: CPU time at one thread, wall time at more",
       &R::build_s},
      {"bytes", "B", "memory held after the build, without the scene", &R::bytes},
      {"peak_bytes", "B", "most memory held at once while building", &R::peak_bytes},
      {"nx", "1", "effective cells along x (top level)", &R::nx},
      {"ny", "1", "effective cells along y (top level)", &R::ny},
      {"nz", "1", "effective cells along z (top level)", &R::nz},
      {"cells", "1", "elementary cells or leaves (N_V)", &R::cells},
      {"references", "1", "primitives in cells, duplicates counted (N_OIV)", &R::references},
      {"steps_per_ray", "1", "nodes and cells visited, inner ones too (N_TS)", &R::steps_per_ray},
      {"cell_steps_per_ray", "1", "elementary cells visited (N_ETS)", &R::cell_steps_per_ray},
      {"empty_cell_steps_per_ray", "1", "of those, empty ones (N_EETS)", &R::empty_cell_steps_per_ray},
      {"tests_per_ray", "1", "ray-primitive tests (N_IT)", &R::tests_per_ray},
      {"mrays_per_s", "10^6/s",
       "median throughput of the rounds: rays over CPU time at one thread, wall time at more",
       &R::mrays_per_s},
      {"ratio", "1", "throughput over the baseline's: median of the per-round ratios of one race", &R::ratio},
      {"ratio_low", "1",
       "lower end of the order-statistic interval of that median; its confidence is 1 - 2^(1 - rounds) up to "
       "8 rounds, and at least 95% from 6 rounds on",
       &R::ratio_low},
      {"ratio_high", "1", "upper end of that interval", &R::ratio_high},
      {"right", "1", "answers equal to the truth in primitive and bits of t", &R::right},
      {"within_bound", "1", "t within the bound of a float kernel: same primitive, or one that near",
       &R::within_bound},
      {"tie", "1", "another primitive whose t is within 2 ulp of the truth's", &R::tie},
      {"edge", "1",
       "the disputed primitive is passed so near its edge that a float kernel can't tell the side", &R::edge},
      {"grazing", "1", "the disputed primitive is met almost edge-on", &R::grazing},
      {"at_limit", "1", "the disputed hit lies at tnear or tfar", &R::at_limit},
      {"degenerate", "1", "the disputed primitive has almost no area", &R::degenerate},
      {"wrong", "1", "contradicts brute force, and no class explains it", &R::wrong},
      {"not_given", "1", "no answer was given (rays outside what the structure accepts)", &R::not_given},
      {"unexplained", "1", "differs from the truth and was not examined", &R::unexplained},
      {"isa", "", "instruction set of the traversal", &R::isa},
      {"threads", "1", "threads that trace, and that Embree builds with", &R::threads},
      {"rounds", "1", "rounds of the race", &R::rounds},
      {"note", "", "what was clamped, substituted or failed, in words", &R::note},
      {"status", "", "ok; failed: not built, so no results; inconsistent: counted pass differs", &R::status},
      {"key", "", "hash of scene, rays, spec, settings and environment: what a resumed run looks up",
       &R::key},
      {"primitives", "1", "primitives of the scene", &R::primitives},
      {"query", "", "closest or any; of all generations of whitted both", &R::query},
      {"order", "", "order of the rays: tiled, scanline or shuffled", &R::order},
      {"baseline", "", "canonical spec of the baseline", &R::baseline},
      {"baseline_mrays_per_s", "10^6/s", "median throughput of the baseline in the same race",
       &R::baseline_mrays_per_s},
      {"spread", "1", "interquartile range of the per-round ratios over their median", &R::spread},
      {"noisy", "", "yes where the spread is too wide to rely on", &R::noisy},
      {"pinned", "", "whether the one tracing thread was held on one CPU: yes or no", &R::pinned},
      {"empty_cells", "1", "elementary cells without a primitive (N_EV)", &R::empty_cells},
      {"inner_nodes", "1", "inner nodes (N_IN)", &R::inner_nodes},
      {"depth", "1", "levels below the root", &R::depth},
      {"bytes_by_part", "", "`bytes` by part: part=bytes, a blank between parts", &R::bytes_by_part},
      {"test_blocks_per_ray", "1", "blocks of primitives tested together", &R::test_blocks_per_ray},
      {"distinct_tests_per_ray", "1", "tests less the repeated ones", &R::distinct_tests_per_ray},
      {"decides_per_ray", "1", "tests that the filter could not settle", &R::decides_per_ray},
      {"point_locations_per_ray", "1", "descents from the root (octree)", &R::point_locations_per_ray},
      {"subgrids_entered_per_ray", "1", "second-level grids walked (two-level grid)",
       &R::subgrids_entered_per_ray},
      {"steps_p50", "1", "median of the steps of a ray", &R::steps_p50},
      {"steps_p90", "1", "90th percentile of the steps of a ray", &R::steps_p90},
      {"steps_p99", "1", "99th percentile of the steps of a ray", &R::steps_p99},
      {"steps_max", "1", "most steps of any ray", &R::steps_max},
      {"tests_p50", "1", "median of the tests of a ray", &R::tests_p50},
      {"tests_p90", "1", "90th percentile of the tests of a ray", &R::tests_p90},
      {"tests_p99", "1", "99th percentile of the tests of a ray", &R::tests_p99},
      {"tests_max", "1", "most tests of any ray", &R::tests_max},
      {"brute_forced", "1", "rays of the batch whose truth was checked against brute force",
       &R::brute_forced},
      {"seed", "1", "seed of rays and samples", &R::seed},
      {"build_low_s", "s", "shortest of these builds, where there were three or more", &R::build_low_s},
      {"build_high_s", "s", "longest of them", &R::build_high_s},
      {"build_id", "", "hash of the library that made this record; +hash of the plug-in or program",
       &R::build_id},
      {"environment_id", "", "hash of machine, system and build: the entry in environment.json",
       &R::environment_id},
  };
  return table;
}

}  // namespace raymeter
