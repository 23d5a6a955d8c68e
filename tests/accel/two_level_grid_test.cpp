#include "accel/two_level_grid.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "accel/walk_space.h"
#include "tests/accel/grid_tests.h"
#include "tests/accel/slow_walk.h"

namespace raymeter {
namespace {

TEST(TwoLevelGrid, AnswersLikeBruteForce) {
  const std::string specs[] = {
      "two-level-grid",
      "two-level-grid:threshold=0",
      "two-level-grid:cells=3x4x5:threshold=1:leaf-density=20",
      "two-level-grid:amount=0.5:threshold=2:fit=box",
      "two-level-grid:cells=1:threshold=2:leaf-density=8",
      "two-level-grid:density=1:threshold=1000",
      "two-level-grid:rule=kalojanov:threshold=3:leaf-density=2.4",
  };
  expect_brute_force_on_many_scenes(specs, 1000);
}

TEST(TwoLevelGrid, CountsByHand) {
  const Scene scene = two_walls();
  // Two top cells of 1.5 x 1 x 1, each with one triangle. 12 cells for that: cubes of half a unit, 3 x 2 x 2.
  const auto grid = build("two-level-grid:cells=2x1x1:threshold=0:leaf-density=12:fit=box", scene);
  const StructureStats stats = grid->stats();
  EXPECT_EQ(stats.inner_nodes, 2u);
  EXPECT_EQ(stats.cells, 24u);
  EXPECT_EQ(stats.references, 8u);  // each triangle in the four cells of one layer
  EXPECT_EQ(stats.empty_cells, 16u);
  EXPECT_EQ(stats.depth, 2u);

  // Tests the first wall in the first of six cells, hits the second in the last.
  RayCounters c = count(*grid, {{-1, 0.7f, 0.8f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 8u);  // and two sub-grids
  EXPECT_EQ(c.cell_steps, 6u);
  EXPECT_EQ(c.empty_cell_steps, 4u);
  EXPECT_EQ(c.tests, 2u);
  EXPECT_EQ(c.subgrids_entered, 2u);
  // Hits the first wall in the first cell of the first sub-grid.
  c = count(*grid, {{-1, 0.2f, 0.3f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 2u);
  EXPECT_EQ(c.cell_steps, 1u);
  EXPECT_EQ(c.tests, 1u);
  EXPECT_EQ(c.subgrids_entered, 1u);
  // With a threshold of one nothing is crowded.
  const auto flat = build("two-level-grid:cells=2x1x1:threshold=1", scene);
  EXPECT_EQ(flat->stats().depth, 1u);
  EXPECT_EQ(count(*flat, {{-1, 0.7f, 0.8f}, 0, {1, 0, 0}}).steps, 2u);
}

TEST(TwoLevelGrid, CountsLikeASlowWalker) {
  Random random(6);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Scene scene = small_scene(seed, 40);
    const Vec3d extent = scene.bounds().extent();
    if (extent.x == 0 || extent.y == 0 || extent.z == 0) continue;  // thin cells have another rule
    const std::array<std::uint32_t, 3> n{1 + random.below(4), 1 + random.below(4), 1 + random.below(4)};
    const auto grid = build(
        fmt::format("two-level-grid:cells={}x{}x{}:threshold=3:leaf-density=5:fit=box", n[0], n[1], n[2]),
        scene);
    if (!grid->stats().note.empty()) continue;  // a flat scene
    const WalkSpace space(scene.bounds());
    SlowGrid top{{}, {}, n};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      top.low[axis] = space.low[int(axis)];
      top.high[axis] = space.high[int(axis)];
    }
    for (int r = 0; r < 120; ++r) {
      Ray ray;
      for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = random.uniform(-2, 2);
        ray.direction[axis] = random.uniform(-1, 1) - ray.origin[axis];
      }
      if (r % 3 == 0) ray.tfar = random.uniform(0, 1);
      RayCounters expected;
      Hit best;
      const auto matters = [&](long double enter) { return !best.found() || enter <= (long double)(best.t); };
      const auto visit = [&](std::span<const std::uint32_t> primitives) {
        ++expected.steps;
        ++expected.cell_steps;
        expected.empty_cell_steps += primitives.empty();
        for (const std::uint32_t p : primitives) {
          ++expected.tests;
          const float t = scene.visit(p, [&](const auto& shape) { return decide(ray, shape); });
          if (t != no_hit && Hit{t, p} < best) best = {t, p};
        }
      };
      for (const SlowCell& cell : slow_walk(top, ray, ray.tnear, ray.tfar)) {
        if (!matters(cell.enter)) break;
        std::vector<std::uint32_t> listed;
        for (std::uint32_t p = 0; p < scene.primitive_count(); ++p)
          if (slow_overlap(top, cell.index, scene.bounds_of(p), space.margin)) listed.push_back(p);
        if (listed.size() <= 3) {
          visit(listed);
          continue;
        }
        // The cell's own grid: cubes, five for each primitive, rounded to whole numbers.
        ++expected.steps;
        ++expected.subgrids_entered;
        SlowGrid sub;
        long double volume = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          sub.low[axis] = top.plane(axis, cell.index[axis]) - space.margin;
          sub.high[axis] = top.plane(axis, cell.index[axis] + 1) + space.margin;
          volume *= sub.high[axis] - sub.low[axis];
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
          sub.n[axis] = std::max(1u, static_cast<std::uint32_t>(
                                         std::round((sub.high[axis] - sub.low[axis]) *
                                                    std::cbrt(5 * (long double)(listed.size()) / volume))));
        for (const SlowCell& leaf : slow_walk(sub, ray, cell.enter, cell.leave)) {
          if (!matters(leaf.enter)) break;
          std::vector<std::uint32_t> inside;
          for (const std::uint32_t p : listed)
            if (slow_overlap(sub, leaf.index, scene.bounds_of(p), space.margin)) inside.push_back(p);
          visit(inside);
        }
      }
      const RayCounters c = count(*grid, ray);
      ASSERT_EQ(c.steps, expected.steps) << "seed " << seed << ", ray " << r;
      ASSERT_EQ(c.cell_steps, expected.cell_steps);
      ASSERT_EQ(c.empty_cell_steps, expected.empty_cell_steps) << "seed " << seed << ", ray " << r;
      ASSERT_EQ(c.tests, expected.tests) << "seed " << seed << ", ray " << r;
      ASSERT_EQ(c.subgrids_entered, expected.subgrids_entered);
    }
  }
}

}  // namespace
}  // namespace raymeter
