#include "accel/leaf_grid.h"

#include <gmock/gmock.h>

#include "accel/memory_meter.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"
#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

/// Grids with SIMD leaves, for every instruction set of this CPU.
class SimdLeaves : public testing::TestWithParam<const LeafGridKernels*> {
 protected:
  std::string spec(const std::string& structure) const {
    return structure + ":leaf=simd:isa=" + GetParam()->isa;
  }
};

TEST_P(SimdLeaves, AnswersLikeBruteForce) {
  const std::string specs[] = {
      spec("grid"),
      spec("grid:amount=0.3"),
      spec("grid:amount=3"),
      spec("tunable-grid"),
      spec("tunable-grid:cells=1"),
      spec("tunable-grid:cells=8:fit=box"),
      spec("tunable-grid:cells=16x2x5"),
      spec("tunable-grid:density=50"),
      spec("tunable-grid:amount=2:fit=exact"),
      spec("tunable-grid:rule=pbrt"),
      spec("tunable-grid:cells=4"),
      spec("two-level-grid"),
      spec("two-level-grid:threshold=0"),
      spec("two-level-grid:cells=3x4x5:threshold=1:leaf-density=20"),
      spec("two-level-grid:amount=0.5:threshold=2:fit=box"),
      spec("two-level-grid:cells=1:threshold=2:leaf-density=8"),
      spec("two-level-grid:density=1:threshold=1000"),
  };
  expect_brute_force_on_many_scenes(specs, 700);
}

TEST_P(SimdLeaves, AnswersLikeBruteForceInLargerScenes) {
  for (const char* name :
       {"soup:triangles=1500", "clusters:objects=1500", "terrain:triangles=1500", "slivers:triangles=700",
        "stadium:triangles=1500", "clusters:objects=500:primitive=sphere"}) {
    const Scene scene = open_scene(name);
    const auto rays = hostile_rays(3, 150, scene);
    for (const char* structure : {"grid", "tunable-grid", "tunable-grid:cells=1", "grid:amount=0.1",
                                  "two-level-grid", "two-level-grid:cells=2:threshold=1"})
      ASSERT_NO_FATAL_FAILURE(
          expect_brute_force(*build(spec(structure), scene), scene, rays, spec(structure) + " on " + name));
  }
}

/// By boxes triangles are also tested in cells that they come nowhere near.
TEST_P(SimdLeaves, AnswersLikeBruteForceToAnAdversary) {
  const std::string specs[] = {spec("tunable-grid:cells=1"), spec("tunable-grid:cells=9:fit=box"),
                               spec("tunable-grid:cells=5"),
                               spec("two-level-grid:cells=2:threshold=0:leaf-density=20")};
  expect_brute_force_to_an_adversary(specs);
}

TEST_P(SimdLeaves, HitEdgesFromAfar) {
  const std::string specs[] = {spec("tunable-grid:cells=16"), spec("tunable-grid:cells=100x100x1"),
                               spec("two-level-grid:cells=5:threshold=0:leaf-density=30")};
  for (const float at : {0.0f, 1000.0f}) ASSERT_NO_FATAL_FAILURE(expect_edges_hit_from_afar(specs, at));
}

INSTANTIATE_TEST_SUITE_P(AllTargets, SimdLeaves, testing::ValuesIn(leaf_grid_kernels()),
                         [](const auto& test) {
                           std::string name = test.param->isa;
                           std::erase(name, '.');
                           return name;
                         });

TEST(SimdLeavesBuild, IsTheSameForAllInstructionSets) {
  const Scene scene = open_scene("clusters:objects=3000");
  const auto reference = build("grid:leaf=simd", scene)->stats();
  for (const LeafGridKernels* const kernels : leaf_grid_kernels()) {
    const auto stats = build(std::string("grid:leaf=simd:isa=") + kernels->isa, scene)->stats();
    EXPECT_EQ(stats.isa, kernels->isa);
    EXPECT_EQ(stats.references, reference.references);
    EXPECT_EQ(stats.bytes, reference.bytes);
  }
}

TEST(SimdLeavesBuild, CountsByHand) {
  const Scene scene = two_walls();
  // The box reaches from 0.5 to 3.5: four cells of 0.75, the first and the last with one triangle each.
  const auto grid = build("tunable-grid:cells=4x1x1:leaf=simd", scene);
  EXPECT_EQ(grid->stats().cells, 4u);
  EXPECT_EQ(grid->stats().empty_cells, 2u);
  EXPECT_EQ(grid->stats().references, 2u);
  // By cell its first word; two counts and eleven words for each triangle, and a vector's room.
  EXPECT_EQ(grid->stats().bytes, 4u * (4 + 2 * (2 + 11) + 16));

  // Passes the first wall (tested), two empty cells, and hits the second.
  RayCounters c = count(*grid, {{-1, 0.7f, 0.8f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 4u);
  EXPECT_EQ(c.cell_steps, 4u);
  EXPECT_EQ(c.empty_cell_steps, 2u);
  EXPECT_EQ(c.test_blocks, 2u);
  EXPECT_EQ(c.tests, 2u);
  EXPECT_EQ(c.decides, 1u);
  // Hits the first wall in the first cell, and goes no further.
  c = count(*grid, {{-1, 0.2f, 0.3f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 1u);
  EXPECT_EQ(c.tests, 1u);
  // Past the box.
  EXPECT_EQ(count(*grid, {{-1, 2, 0.3f}, 0, {1, 0, 0}}).steps, 0u);
  // From beyond what floats are proved for: the same walk, from where the ray enters the box.
  c = count(*grid, {{-1e4f, 0.7f, 0.8f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 4u);
  EXPECT_EQ(c.tests, 2u);
}

TEST(SimdLeavesBuild, CountsByHandInTwoLevels) {
  const Scene scene = two_walls();
  // As in TwoLevelGrid.CountsByHand: two cells, in each a grid of 3 x 2 x 2 cells.
  const auto grid = build("two-level-grid:cells=2x1x1:threshold=0:leaf-density=12:fit=box:leaf=simd", scene);
  const auto scalar = build("two-level-grid:cells=2x1x1:threshold=0:leaf-density=12:fit=box", scene);
  EXPECT_EQ(grid->stats().inner_nodes, 2u);
  EXPECT_EQ(grid->stats().cells, 24u);
  EXPECT_EQ(grid->stats().empty_cells, 16u);
  EXPECT_EQ(grid->stats().references, 8u);
  EXPECT_EQ(grid->stats().depth, 2u);
  for (const Ray& ray : {Ray{{-1, 0.7f, 0.8f}, 0, {1, 0, 0}}, Ray{{-1, 0.2f, 0.3f}, 0, {1, 0, 0}},
                         Ray{{-1, 2, 0.3f}, 0, {1, 0, 0}}, Ray{{-1e4f, 0.7f, 0.8f}, 0, {1, 0, 0}}}) {
    const RayCounters c = count(*grid, ray), expected = count(*scalar, ray);
    EXPECT_EQ(c.steps, expected.steps);
    EXPECT_EQ(c.cell_steps, expected.cell_steps);
    EXPECT_EQ(c.empty_cell_steps, expected.empty_cell_steps);
    EXPECT_EQ(c.subgrids_entered, expected.subgrids_entered);
    EXPECT_EQ(c.tests, expected.tests);
    EXPECT_EQ(c.test_blocks, expected.tests) << "one triangle in a block";
  }
}

TEST(SimdLeavesBuild, RegistersByTheGridsOwnRule) {
  const Scene scene = open_scene("soup:triangles=3000");
  for (const char* spec :
       {"grid", "grid:amount=0.4", "tunable-grid", "tunable-grid:fit=box", "two-level-grid"}) {
    const auto scalar = build(spec, scene)->stats();
    const auto simd = build(std::string(spec) + ":leaf=simd", scene)->stats();
    EXPECT_EQ(simd.resolution, scalar.resolution) << spec;
    // The margin of registration is wider.
    EXPECT_GE(simd.references, scalar.references) << spec;
    EXPECT_LT(double(simd.references), 1.01 * double(scalar.references)) << spec;
  }
}

template <class Throws>
std::string message_of(const Throws& throws) {
  try {
    throws();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(SimdLeavesBuild, RefusesWhatItCanNotDo) {
  const Scene scene = open_scene("soup:triangles=2000");
  const auto refusal = [&](const char* spec) { return message_of([&] { build(spec, scene); }); };
  EXPECT_EQ(refusal("tunable-grid:leaf=simd:mailbox=on"),
            "tunable-grid: mailbox=on goes with leaf=scalar only");
  EXPECT_EQ(refusal("tunable-grid:isa=sse4.2"), "tunable-grid: isa=sse4.2 goes with leaf=simd only");
  EXPECT_EQ(refusal("grid:isa=sse4.2"), "grid: isa=sse4.2 goes with leaf=simd only");
  EXPECT_EQ(refusal("two-level-grid:isa=sse4.2"), "two-level-grid: isa=sse4.2 goes with leaf=simd only");
  EXPECT_THROW(build("grid:leaf=wide", scene), Error);
  EXPECT_THROW(build("grid:leaf=simd", scene, 50'000), MemoryLimitExceeded);
  SceneData data;
  data.name = "huge";
  data.vertices = {{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}};
  data.triangles = {{0, 1, 2}};
  EXPECT_THROW(build("grid:leaf=simd", Scene(std::move(data))), Error);
}

}  // namespace
}  // namespace raymeter
