#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raymeter {

/// What one ray cost. Defined once, in the letters of Havran ("Heuristic Ray Shooting Algorithms", 2000), so
/// that published tables can be laid beside ours.
struct RayCounters {
  std::uint32_t steps = 0;             ///< N_TS: nodes and cells visited, inner ones too
  std::uint32_t cell_steps = 0;        ///< N_ETS: elementary cells (grid cells, leaves) visited
  std::uint32_t empty_cell_steps = 0;  ///< N_EETS: of those, the ones that hold no primitive
  std::uint32_t tests = 0;             ///< N_IT: ray-primitive tests
  std::uint32_t test_blocks = 0;       ///< blocks of primitives tested together (SIMD); 0 in scalar code
  std::uint32_t distinct_tests = 0;    ///< of the tests, first ones of a primitive by this ray
  std::uint32_t decides = 0;           ///< tests that the filter could not settle: calls of `decide`
  std::uint32_t point_locations = 0;   ///< descents from the root to find the cell of a point (octree)
  std::uint32_t subgrids_entered = 0;  ///< second-level grids walked (two-level grid)
};

/// The probe of timed code: compiles to nothing.
struct NoProbe {
  void select(std::size_t /*ray*/) {}
  void inner_step() {}
  void cell_step(bool /*empty*/) {}
  void test(std::uint32_t /*primitive*/) {}
  void test_block() {}
  void decide() {}
  void point_location() {}
  void enter_subgrid() {}
};

/// The probe of the counted pass. One for each thread; `begin_ray` before each ray, or `begin_rays` before
/// such as are traced together, and `select` before what one of these costs.
class CountingProbe {
 public:
  static constexpr std::size_t most_together = 16;

  explicit CountingProbe(std::size_t primitive_count) : tested_(primitive_count, 0) {}

  void begin_ray(RayCounters& counters) { begin_rays({&counters, 1}); }
  void begin_rays(std::span<RayCounters> counters) {
    for (RayCounters& c : counters) c = {};
    rays_ = counters;
    ++group_;
    select(0);
  }
  void select(std::size_t ray) {
    counters_ = &rays_[ray];
    bit_ = std::uint64_t{1} << ray;
  }

  void inner_step() { ++counters_->steps; }
  void cell_step(bool empty) {
    ++counters_->steps;
    ++counters_->cell_steps;
    counters_->empty_cell_steps += empty;
  }
  void test(std::uint32_t primitive) {
    ++counters_->tests;
    std::uint64_t& tested = tested_[primitive];
    if (tested >> most_together != group_) tested = group_ << most_together;
    if ((tested & bit_) == 0) {
      tested |= bit_;
      ++counters_->distinct_tests;
    }
  }
  void test_block() { ++counters_->test_blocks; }
  void decide() { ++counters_->decides; }
  void point_location() { ++counters_->point_locations; }
  void enter_subgrid() { ++counters_->subgrids_entered; }

 private:
  std::span<RayCounters> rays_;
  RayCounters* counters_ = nullptr;
  std::uint64_t group_ = 0, bit_ = 1;
  std::vector<std::uint64_t> tested_;  // by primitive: the last group that tested it, and which rays of it
};

}  // namespace raymeter
