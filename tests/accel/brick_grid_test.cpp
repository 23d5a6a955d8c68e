#include "accel/brick_grid.h"

#include <gmock/gmock.h>

#include "accel/brick_kernels.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"
#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

/// For every instruction set of this CPU.
class BrickGrid : public testing::TestWithParam<const BrickKernels*> {
 protected:
  std::string spec(const std::string& arguments) const {
    return std::string("brick-grid:isa=") + GetParam()->isa + (arguments.empty() ? "" : ":") + arguments;
  }
};

TEST_P(BrickGrid, AnswersLikeBruteForce) {
  const std::string specs[] = {
      spec(""),
      spec("cells=1:leaf=1"),
      spec("cells=2x3x1:leaf=2"),
      spec("density=4:leaf=4"),
      spec("cells=1:leaf=8"),
  };
  expect_brute_force_on_many_scenes(specs, 700);
}

TEST_P(BrickGrid, AnswersLikeBruteForceInDeepTrees) {
  for (const char* name :
       {"soup:triangles=1500", "clusters:objects=1500", "terrain:triangles=1500", "slivers:triangles=700",
        "stadium:triangles=1500", "clusters:objects=500:primitive=sphere"}) {
    const Scene scene = open_scene(name);
    const auto rays = hostile_rays(3, 150, scene);
    for (const char* arguments : {"", "cells=1", "cells=1:leaf=2", "density=0.5"})
      ASSERT_NO_FATAL_FAILURE(
          expect_brute_force(*build(spec(arguments), scene), scene, rays, spec(arguments) + " on " + name));
  }
}

TEST_P(BrickGrid, HitsEdgesFromAfar) {
  const std::string specs[] = {spec(""), spec("cells=8"), spec("cells=2:leaf=1")};
  for (const float at : {0.0f, 1000.0f}) ASSERT_NO_FATAL_FAILURE(expect_edges_hit_from_afar(specs, at));
}

INSTANTIATE_TEST_SUITE_P(AllTargets, BrickGrid, testing::ValuesIn(brick_kernels()), [](const auto& test) {
  std::string name = test.param->isa;
  std::erase(name, '.');
  return name;
});

TEST(BrickGridBuild, IsTheSameForAllInstructionSets) {
  const Scene scene = open_scene("clusters:objects=3000");
  const auto reference = build("brick-grid", scene)->stats();
  EXPECT_GT(reference.depth, 1u);
  for (const BrickKernels* const kernels : brick_kernels()) {
    const auto stats = build(std::string("brick-grid:isa=") + kernels->isa, scene)->stats();
    EXPECT_EQ(stats.isa, kernels->isa);
    EXPECT_EQ(stats.cells, reference.cells);
    EXPECT_EQ(stats.inner_nodes, reference.inner_nodes);
    EXPECT_EQ(stats.references, reference.references);
    EXPECT_EQ(stats.bytes, reference.bytes);
  }
}

TEST(BrickGridBuild, CountsByHand) {
  // Two small walls across the x axis, in the first and the last cell of the only brick.
  SceneData data;
  data.name = "corners";
  data.vertices = {{0, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}, {4, 1, 1}, {4, 0.9f, 1}, {4, 1, 0.9f}};
  data.triangles = {{0, 1, 2}, {3, 4, 5}};
  const Scene scene(std::move(data));
  const auto bricks = build("brick-grid:cells=1:leaf=1", scene);
  const StructureStats stats = bricks->stats();
  EXPECT_EQ(stats.inner_nodes, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.references, 2u);
  EXPECT_EQ(stats.empty_cells, 0u);
  EXPECT_EQ(stats.depth, 2u);

  // Hits the one wall or the other: the brick, and the leaf.
  for (const Vec3& from : {Vec3{-1, 0.02f, 0.03f}, Vec3{-1, 0.98f, 0.97f}}) {
    const RayCounters c = count(*bricks, {from, 0, {1, 0, 0}});
    EXPECT_EQ(c.steps, 2u);
    EXPECT_EQ(c.cell_steps, 1u);
    EXPECT_EQ(c.test_blocks, 1u);
    EXPECT_EQ(c.tests, 1u);
    EXPECT_EQ(c.decides, 1u);
  }
  // Passes between them through cells that are empty.
  RayCounters c = count(*bricks, {{-1, 0.5f, 0.5f}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 1u);
  EXPECT_EQ(c.tests, 0u);
  // Passes beside the scene.
  c = count(*bricks, {{-1, 5, 5}, 0, {1, 0, 0}});
  EXPECT_EQ(c.steps, 0u);
}

TEST(BrickGridBuild, SplitsWhatIsCrowdedAndNotWhatIsNot) {
  const Scene few = open_scene("soup:triangles=16");
  EXPECT_EQ(build("brick-grid:cells=1", few)->stats().inner_nodes, 0u);
  const Scene many = open_scene("soup:triangles=3000");
  EXPECT_GT(build("brick-grid:cells=1", many)->stats().inner_nodes, 0u);
}

/// A few triangles as the scene's only leaf, and split by force.
TEST_P(BrickGrid, AnswersLikeBruteForceToAnAdversary) {
  const std::string specs[] = {spec("cells=1"), spec("cells=1:leaf=1")};
  expect_brute_force_to_an_adversary(specs);
}

TEST_P(BrickGrid, TakesDirectionsOfEveryLength) {
  const Scene scene = open_scene("soup:triangles=400");
  auto rays = hostile_rays(5, 400, scene);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3& d = rays[i].direction;
    const float longest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z), 1e-30f});
    constexpr float lengths[] = {3e38f, 1e37f, 2e30f, 1e-29f, 1e-36f, 2e-38f};
    rays[i].direction = lengths[i % std::size(lengths)] * (1 / longest * d);
    rays[i].tfar = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(rays[i].direction[axis]) < std::numeric_limits<float>::min()) rays[i].direction[axis] = 0;
  }
  expect_brute_force(*build(spec("leaf=4"), scene), scene, rays, "lengths");
}

TEST(BrickGridBuild, RefusesWhatItCanNotDo) {
  const Scene scene = open_scene("soup:triangles=2000");
  EXPECT_THROW(build("brick-grid", scene, 50'000), MemoryLimitExceeded);
  SceneData data;
  data.name = "huge";
  data.vertices = {{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}};
  data.triangles = {{0, 1, 2}};
  EXPECT_THROW(build("brick-grid", Scene(std::move(data))), Error);
}

}  // namespace
}  // namespace raymeter
