#include "accel/uniform_grid.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "accel/memory_meter.h"
#include "accel/walk_space.h"
#include "scenes/base/error.h"
#include "tests/accel/grid_tests.h"
#include "tests/accel/slow_walk.h"

namespace raymeter {
namespace {

TEST(UniformGrid, AnswersLikeBruteForce) {
  const std::string specs[] = {
      "grid",
      "grid:amount=0.3",
      "grid:amount=3",
      "tunable-grid",
      "tunable-grid:cells=1",
      "tunable-grid:cells=8:fit=box:mailbox=on",
      "tunable-grid:cells=16x2x5:mailbox=on",
      "tunable-grid:density=50",
      "tunable-grid:amount=2:fit=exact",
      "tunable-grid:rule=pbrt",
      "tunable-grid:cells=4:fit=exact",
  };
  expect_brute_force_on_many_scenes(specs, 1000);
}

/// A wall in the very plane between the cells, whose lower edge is the very line where four cells meet: rays
/// that change sides on both axes at once pass it through one of two other cells, as the rounding has it.
/// Only the margin of registration puts the wall in both.
TEST(UniformGrid, MarginCatchesWhatRoundingMisses) {
  SceneData data;
  data.name = "cross";
  data.vertices = {{0, 0, -1},      {0, 0, 1}, {0, 1, 0},    {-1, -1, -1}, {-1, -0.9f, -1},
                   {-1, -1, -0.9f}, {1, 1, 1}, {1, 0.9f, 1}, {1, 1, 0.9f}};
  data.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
  const Scene scene{std::move(data)};
  Random random(9);
  std::vector<Ray> rays(2000);
  for (Ray& ray : rays) {
    ray.origin = {random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    ray.direction = -ray.origin;  // through 0 at t = 1, exactly
  }
  for (const char* spec :
       {"tunable-grid:cells=2:fit=box", "tunable-grid:cells=2", "two-level-grid:cells=2:threshold=0"})
    expect_brute_force(*build(spec, scene), scene, rays, spec);
}

TEST(UniformGrid, CountsByHand) {
  const Scene scene = two_walls();
  // The box reaches from 0.5 to 3.5: four cells of 0.75, the first and the last with one triangle each.
  const auto grid = build("tunable-grid:cells=4x1x1", scene);
  EXPECT_EQ(grid->stats().cells, 4u);
  EXPECT_EQ(grid->stats().empty_cells, 2u);
  EXPECT_EQ(grid->stats().references, 2u);
  // A word of cells and what lies before it, three offsets, two references; and two runs while building.
  EXPECT_EQ(grid->stats().bytes, 8u + 4u + 4u * (3 + 2));
  EXPECT_EQ(grid->stats().peak_bytes, grid->stats().bytes + 8u * 2);

  // Passes the first wall (tested), two empty cells, and hits the second.
  RayCounters c = count(*grid, {{-1, 0.7f, 0.8f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 4u);
  EXPECT_EQ(c.cell_steps, 4u);
  EXPECT_EQ(c.empty_cell_steps, 2u);
  EXPECT_EQ(c.tests, 2u);
  EXPECT_EQ(c.distinct_tests, 2u);
  // Hits the first wall in the first cell, and goes no further.
  c = count(*grid, {{-1, 0.2f, 0.3f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 1u);
  EXPECT_EQ(c.tests, 1u);
  // Begins in the second cell (1.25 to 2) and ends in the third (2 to 2.75): two empty cells.
  c = count(*grid, {{1.5f, 0.2f, 0.3f}, 0, {1, 0, 0}, 1});
  EXPECT_EQ(c.steps, 2u);
  EXPECT_EQ(c.empty_cell_steps, 2u);
  EXPECT_EQ(c.tests, 0u);
  // Across the second cell.
  c = count(*grid, {{1.5f, -1, 0.3f}, 0, {0, 1, 0}});
  EXPECT_EQ(c.steps, 1u);
  EXPECT_EQ(c.empty_cell_steps, 1u);
  // Past the box; and not traceable.
  EXPECT_EQ(count(*grid, {{-1, 2, 0.3f}, 0, {1, 0, 0}}).steps, 0u);
  EXPECT_EQ(count(*grid, {{-1, 0.5f, 0.3f}, 0, {0, 0, 0}}).steps, 0u);
  // From beyond 2^16 diagonals every primitive is tested, without a walk.
  c = count(*grid, {{-1e7f, 0.7f, 0.8f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 0u);
  EXPECT_EQ(c.tests, 2u);
}

TEST(UniformGrid, MailboxTestsOnce) {
  const Scene scene = two_walls();
  const Ray ray{{0.5f, -1, 0.25f}, 0, {0, 1, 0}};  // in the plane of the first wall, which it so can't hit
  // Both cells along y hold the first wall.
  EXPECT_EQ(count(*build("tunable-grid:cells=1x2x1:fit=box", scene), ray).tests, 4u);
  const RayCounters c = count(*build("tunable-grid:cells=1x2x1:fit=box:mailbox=on", scene), ray);
  EXPECT_EQ(c.tests, 2u);
  EXPECT_EQ(c.steps, 2u);
}

TEST(UniformGrid, CountsLikeASlowWalker) {
  Random random(5);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Scene scene = small_scene(seed, 40);
    if (scene.bounds().empty()) continue;
    const std::array<std::uint32_t, 3> n{1 + random.below(12), 1 + random.below(12), 1 + random.below(12)};
    const auto grid = build(fmt::format("tunable-grid:cells={}x{}x{}:fit=box", n[0], n[1], n[2]), scene);
    if (!grid->stats().note.empty()) continue;  // a flat scene
    const WalkSpace space(scene.bounds());
    SlowGrid slow{{}, {}, n};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      slow.low[axis] = space.low[int(axis)];
      slow.high[axis] = space.high[int(axis)];
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
      for (const SlowCell& cell : slow_walk(slow, ray, ray.tnear, ray.tfar)) {
        if (best.found() && cell.enter > (long double)(best.t)) break;
        ++expected.steps;
        std::uint32_t listed = 0;
        for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) {
          if (!slow_overlap(slow, cell.index, scene.bounds_of(p), space.margin)) continue;
          ++listed;
          const float t = scene.visit(p, [&](const auto& shape) { return decide(ray, shape); });
          if (t != no_hit && Hit{t, p} < best) best = {t, p};
        }
        expected.tests += listed;
        expected.empty_cell_steps += listed == 0;
      }
      const RayCounters c = count(*grid, ray);
      ASSERT_EQ(c.steps, expected.steps) << "seed " << seed << ", ray " << r;
      ASSERT_EQ(c.cell_steps, expected.steps);
      ASSERT_EQ(c.empty_cell_steps, expected.empty_cell_steps);
      ASSERT_EQ(c.tests, expected.tests) << "seed " << seed << ", ray " << r;
    }
  }
}

/// `count` triangles of size 1e-3 in one place, and if `far` one at a distance of 1.
Scene crowd(std::uint32_t count, bool far) {
  SceneData data;
  data.name = "crowd";
  data.vertices = {{0, 0, 0}, {1e-3f, 0, 1e-3f}, {0, 1e-3f, 5e-4f}, {1, 1, 1}, {1, 0.9f, 1}, {0.9f, 1, 0.9f}};
  data.triangles.assign(count, {0, 1, 2});
  if (far) data.triangles.push_back({3, 4, 5});
  return Scene(std::move(data));
}

TEST(UniformGrid, CoincidentTrianglesDoNotBlowUp) {
  const Scene far = crowd(100000, true);
  for (const char* spec : {"tunable-grid", "two-level-grid"})
    EXPECT_LT(build(spec, far)->stats().peak_bytes, 100u << 20u) << spec;
  // Every triangle fills the whole box: cells are given up, and it is said.
  const Scene near = crowd(20000, false);
  const auto all = build("tunable-grid:cells=256:fit=box", near);
  EXPECT_THAT(all->stats().note, testing::HasSubstr("clamped from 256x256x256 to "));
  EXPECT_LT(all->stats().references, (1u << 26u) + 1);
}

TEST(UniformGrid, KeepsToItsMemory) {
  const Scene scene = small_scene(3, 40);
  const auto grid = build("tunable-grid:cells=64", scene, 400000);
  // Half the memory holds 50,000 offsets: 36^3 = 46,656.
  EXPECT_EQ(grid->stats().note, "clamped from 64x64x64 to 36x36x36 (limit 50000 cells)");
  EXPECT_LE(grid->stats().peak_bytes, 400000u);
  EXPECT_THROW(build("tunable-grid", crowd(1000, true), 3000), MemoryLimitExceeded);
  EXPECT_THROW(build("two-level-grid", crowd(1000, true), 3000), MemoryLimitExceeded);
}

TEST(UniformGrid, RefusesTwoWaysToChoose) {
  const Scene scene = two_walls();
  EXPECT_THROW(build("tunable-grid:cells=4:density=2", scene), Error);
  EXPECT_THROW(build("tunable-grid:amount=1:rule=wald", scene), Error);
  EXPECT_THROW(build("tunable-grid:cells=1.5", scene), Error);
  EXPECT_THROW(build("tunable-grid:rule=nobody", scene), Error);
  // A canonical spec can be read again.
  Registry registry;
  register_accel(registry);
  const std::string canonical = registry.arguments(parse_spec("tunable-grid:density=2")).canonical();
  EXPECT_EQ(registry.arguments(parse_spec(canonical)).canonical(), canonical);
}

}  // namespace
}  // namespace raymeter
