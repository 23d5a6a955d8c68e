// Builds on several threads: the same structure, to the bit, as on one.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "accel/cell_lists.h"
#include "accel/octree_cells.h"
#include "accel/parallel.h"
#include "scenes/open_scene.h"
#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

/// Runs f in an arena of that many threads, as Registry::build does.
template <class F>
void with_threads(int threads, const F& f) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute(f);
}

TEST(Parallel, ThreadsOfABuildFlushDenormals) {
  with_threads(4, [] {
    std::atomic<int> denormal = 0;
    for_ranges(1000, 1, [&](std::uint64_t, std::uint64_t) {
      volatile float least = std::numeric_limits<float>::min();
      if (least * 0.5f != 0) ++denormal;
    });
    EXPECT_EQ(denormal, FlushDenormals::available ? 0 : 1000);
  });
}

TEST(Parallel, SumsAreEqualForAnyNumberOfThreads) {
  Random random(3);
  std::vector<double> terms(100000);
  for (double& term : terms) term = random.uniform(-1, 1) * (random.below(2) == 0 ? 1e9 : 1e-9);
  std::vector<double> sums;
  for (const int threads : {1, 2, 3, 8})
    with_threads(threads, [&] {
      sums.push_back(sum_of_ranges<double>(terms.size(), 100, [&](std::uint64_t begin, std::uint64_t end) {
        double part = 0;
        for (std::uint64_t i = begin; i < end; ++i) part += terms[i];
        return part;
      }));
    });
  EXPECT_EQ(sums, std::vector<double>(4, sums[0]));
}

TEST(Parallel, MiddlesAreInOrder) {
  for (const int threads : {1, 2, 7})
    with_threads(threads, [&] {
      constexpr std::uint64_t items = 1000;
      std::vector<int> steps(items);
      std::vector<std::uint64_t> middles;
      for_each_in_order(
          items, [&](std::uint64_t i) { EXPECT_EQ(steps[i]++, 0); },
          [&](std::uint64_t i) {
            EXPECT_EQ(steps[i]++, 1);
            middles.push_back(i);
          },
          [&](std::uint64_t i) { EXPECT_EQ(steps[i]++, 2); });
      EXPECT_EQ(steps, std::vector<int>(items, 3));
      ASSERT_EQ(middles.size(), items);
      EXPECT_TRUE(std::ranges::is_sorted(middles));
    });
  for_each_in_order(
      0, [](std::uint64_t) { FAIL(); }, [](std::uint64_t) { FAIL(); }, [](std::uint64_t) { FAIL(); });
}

/// Every list in full.
std::vector<std::vector<std::uint32_t>> lists_of(const CellLists& lists) {
  std::vector<std::vector<std::uint32_t>> all;
  for (std::uint64_t c = 0; c < lists.cells(); ++c) all.emplace_back(lists[c].begin(), lists[c].end());
  return all;
}

TEST(CellLists, AreEqualForAnyNumberOfThreads) {
  const std::uint64_t primitives = 20000, cells = 97;
  const auto enumerate = [&](std::uint32_t p, const auto& add) {
    for (std::uint64_t c = p % 89; c < cells; c += 1 + p % 7) add(c);
    if (p % 2 == 0) add(96);  // one that is crowded
  };
  std::vector<std::vector<std::uint32_t>> expected(cells);
  for (std::uint32_t p = 0; p < primitives; ++p)
    enumerate(p, [&](std::uint64_t c) { expected[c].push_back(p); });
  for (const int threads : {1, 2, 5})
    with_threads(threads, [&] {
      MemoryMeter meter;
      CellLists lists(meter);
      lists.build(cells, primitives, enumerate);
      EXPECT_EQ(lists_of(lists), expected) << threads;
    });
}

TEST(Octree, IsEqualForAnyNumberOfThreads) {
  const Scene scene = open_scene("soup:triangles=20000:seed=3");
  const auto build = [&](int threads) {
    std::vector<std::uint32_t> all;
    with_threads(threads, [&] {
      MemoryMeter meter;
      const OctreeCells tree = build_octree_cells(scene, 8, 14, meter);
      for (const OctreeNode& node : tree.nodes) all.insert(all.end(), {node.first, node.count});
      all.insert(all.end(), tree.references.begin(), tree.references.end());
    });
    return all;
  };
  const auto one = build(1);
  EXPECT_GT(one.size(), 40000u);
  EXPECT_EQ(build(2), one);
  EXPECT_EQ(build(5), one);
}

/// What shows of a structure: its numbers, and what each of the rays cost.
std::string seen_from_outside(std::string_view spec, const Scene& scene, std::span<const Ray> rays,
                              unsigned threads) {
  Registry registry;
  register_accel(registry);
  const auto structure = registry.build(parse_spec(spec), {scene, threads});
  const StructureStats stats = structure->stats();
  std::string seen = fmt::format("{} {} {} {} {} {}", stats.cells, stats.empty_cells, stats.inner_nodes,
                                 stats.references, stats.bytes, stats.note);
  std::vector<Hit> hits(rays.size());
  std::vector<RayCounters> counters(rays.size());
  structure->count_closest({rays}, hits, counters);
  for (const RayCounters& c : counters) seen += fmt::format(" {},{},{}", c.steps, c.tests, c.decides);
  return seen;
}

TEST(ParallelBuild, EveryStructureCostsTheSameForAnyNumberOfThreads) {
  for (const char* name : {"soup:triangles=3000", "clusters:objects=3000", "terrain:triangles=3000"}) {
    const Scene scene = open_scene(name);
    const auto rays = hostile_rays(7, 200, scene);
    for (const char* spec : {"grid", "tunable-grid:mailbox=on", "octree", "octree:traversal=top-down",
                             "two-level-grid", "two-level-grid:threshold=1:fit=box", "brick-grid",
                             "grid:leaf=simd", "tunable-grid:leaf=simd", "two-level-grid:leaf=simd"}) {
      const std::string one = seen_from_outside(spec, scene, rays, 1);
      EXPECT_EQ(seen_from_outside(spec, scene, rays, 2), one) << spec << " on " << name;
      EXPECT_EQ(seen_from_outside(spec, scene, rays, 6), one) << spec << " on " << name;
    }
  }
}

/// Where a scene is more than a cache holds, bricks are made in another order, of corners that are fetched
/// once.
TEST(ParallelBuild, OfBricksIsTheSameWhereTheSceneIsLarge) {
  const Scene soup = open_scene("soup:triangles=30000:size=0.05"),
              spheres = open_scene("clusters:objects=10000:primitive=sphere");
  const auto with_vertices = [&](std::size_t more) {
    SceneData data;
    data.name = "mixed";
    data.vertices.assign(soup.vertices().begin(), soup.vertices().end());
    data.vertices.resize(data.vertices.size() + more, data.vertices[0]);  // that no triangle has
    data.triangles.assign(soup.triangles().begin(), soup.triangles().end());
    data.quadrics.assign(spheres.quadrics().begin(), spheres.quadrics().end());
    return Scene(std::move(data));
  };
  const Scene small = with_vertices(0), large = with_vertices(400000);
  const auto rays = hostile_rays(9, 200, small);
  for (const char* spec : {"brick-grid", "brick-grid:cells=1", "brick-grid:leaf=1"}) {
    const std::string one = seen_from_outside(spec, small, rays, 1);
    for (const unsigned threads : {1, 2, 6})
      EXPECT_EQ(seen_from_outside(spec, large, rays, threads), one) << spec << ' ' << threads;
  }
}

/// Nodes of more than 16,384 primitives are made by all threads together.
TEST(ParallelBuild, OfLargeBrickNodesIsTheSameAndRight) {
  for (const char* name : {"soup:triangles=20000:size=0.05", "clusters:objects=20000:primitive=sphere"}) {
    const Scene scene = open_scene(name);
    const auto rays = hostile_rays(8, 60, scene);
    const std::string spec = "brick-grid:cells=1";
    const std::string one = seen_from_outside(spec, scene, rays, 1);
    EXPECT_EQ(seen_from_outside(spec, scene, rays, 2), one) << name;
    EXPECT_EQ(seen_from_outside(spec, scene, rays, 6), one) << name;
    const auto bricks = build(spec, scene);
    EXPECT_GT(bricks->stats().depth, 2u);
    expect_brute_force(*bricks, scene, rays, name);
  }
  // One whose primitives are all in the same place, and so a leaf.
  SceneData data;
  data.name = "pile";
  data.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  data.triangles.assign(20000, {0, 1, 2});
  const Scene pile(std::move(data));
  const auto rays = hostile_rays(9, 20, pile);
  const auto bricks = build("brick-grid", pile);
  EXPECT_EQ(bricks->stats().inner_nodes, 0u);
  expect_brute_force(*bricks, pile, rays, "pile");
}

}  // namespace
}  // namespace raymeter
