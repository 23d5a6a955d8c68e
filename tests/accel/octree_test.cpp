#include "accel/octree.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "accel/memory_meter.h"
#include "accel/walk_space.h"
#include "tests/accel/slow_octree.h"
#include "tests/baselines/test_rays.h"

namespace raymeter {
namespace {

constexpr const char* traversals[] = {"glassner", "top-down"};

std::unique_ptr<Structure> octree(const Scene& scene, std::uint32_t leaf, int depth, const char* traversal,
                                  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max()) {
  Registry registry;
  register_accel(registry);
  return registry.build(
      parse_spec(fmt::format("octree:leaf={}:depth={}:traversal={}", leaf, depth, traversal)),
      {scene, 1, memory_limit});
}

struct Counted {
  std::vector<Hit> hits;
  std::vector<RayCounters> counters;
};

Counted count_closest(const Structure& structure, std::span<const Ray> rays) {
  Counted counted{std::vector<Hit>(rays.size()), std::vector<RayCounters>(rays.size())};
  structure.count_closest({rays}, counted.hits, counted.counters);
  return counted;
}

/// Every answer of the octree, timed and counted, is brute force's.
void expect_the_truth(const Scene& scene, const Structure& structure, std::span<const Ray> rays) {
  const std::vector<Hit> truth = closest(*build("brute-force", scene), rays);
  const std::vector<Hit> hits = closest(structure, rays);
  const std::vector<std::uint8_t> occluded = any(structure, rays);
  std::vector<std::uint8_t> occluded_counted(rays.size());
  std::vector<RayCounters> counters(rays.size());
  structure.count_any({rays, QueryKind::any}, occluded_counted, counters);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    const std::string which =
        fmt::format("ray {}: {} {} {} -> {} {} {}, {}..{}", i, ray.origin.x, ray.origin.y, ray.origin.z,
                    ray.direction.x, ray.direction.y, ray.direction.z, ray.tnear, ray.tfar);
    ASSERT_EQ(hits[i].primitive, truth[i].primitive) << which;
    ASSERT_EQ(hits[i].t, truth[i].t) << which;
    ASSERT_EQ(occluded[i], truth[i].found()) << which;
  }
  EXPECT_EQ(count_closest(structure, rays).hits, hits);
  EXPECT_EQ(occluded_counted, occluded);
}

/// Axis-parallel and slanted rays on the very planes between the octree's cells.
std::vector<Ray> rays_on_cell_planes(std::uint64_t seed, std::size_t count, const Scene& scene) {
  Random random(seed);
  const WalkSpace space(scene.bounds());
  const Vec3d extent = space.extent();
  const double side = std::max({extent.x, extent.y, extent.z});
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    constexpr float components[] = {-1, -0.0f, 0.0f, 1};
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = static_cast<float>(space.low[axis] + side * random.below(17) / 16);
      ray.direction[axis] = random.below(4) == 0 ? random.uniform(-1, 1) : components[random.below(4)];
    }
    if (random.below(2) == 0) ray.origin = ray.origin - static_cast<float>(2 * side) * ray.direction;
    if (random.below(4) == 0) ray.tnear = -std::numeric_limits<float>::infinity();
  }
  return rays;
}

/// The scene times `factor`, moved by `shift`.
Scene moved(const Scene& scene, float factor, const Vec3& shift) {
  SceneData data;
  for (const Vec3& vertex : scene.vertices()) data.vertices.push_back(factor * vertex + shift);
  data.triangles.assign(scene.triangles().begin(), scene.triangles().end());
  for (Quadric quadric : scene.quadrics()) {
    quadric.base = factor * quadric.base + shift;
    quadric.base_radius *= factor;
    if (quadric.kind != QuadricKind::sphere) quadric.apex = factor * quadric.apex + shift;
    quadric.apex_radius *= factor;
    data.quadrics.push_back(quadric);
  }
  return Scene(std::move(data));
}

Scene triangle_scene(std::initializer_list<Triangle> triangles) {
  SceneData data;
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(data.vertices.size());
    for (const Vec3& vertex : {triangle.a, triangle.b, triangle.c}) data.vertices.push_back(vertex);
    data.triangles.push_back({first, first + 1, first + 2});
  }
  return Scene(std::move(data));
}

constexpr Triangle low_corner{{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}};
constexpr Triangle high_corner{{1, 1, 1}, {0.9f, 1, 1}, {1, 0.9f, 1}};
/// Just below the middle of the unit cube.
constexpr Triangle middle{{0.4f, 0.4f, 0.4f}, {0.45f, 0.4f, 0.4f}, {0.4f, 0.45f, 0.4f}};

TEST(Octree, FindsWhatBruteForceFindsInThousandsOfScenes) {
  Random random(1);
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const Scene scene = mixed_scene(seed, random.below(24), random.below(12));
    if (scene.bounds().empty()) continue;
    std::vector<Ray> rays = adversarial_rays(seed, 20, scene);
    for (const auto& more : {random_rays(seed, 10), rays_on_cell_planes(seed, 10, scene)})
      rays.insert(rays.end(), more.begin(), more.end());
    const auto structure =
        octree(scene, 1 + random.below(6), static_cast<int>(random.below(7)), traversals[seed % 2]);
    SCOPED_TRACE(fmt::format("scene {}", seed));
    expect_the_truth(scene, *structure, rays);
    if (HasFatalFailure()) return;
  }
}

TEST(Octree, FindsWhatBruteForceFindsInDeepTrees) {
  const Scene mixed = mixed_scene(3, 300, 100);
  const Scene terrain = terrain_scene(4, 16);
  for (const Scene* scene : {&mixed, &terrain})
    for (const char* traversal : traversals)
      for (const auto& [leaf, depth] : {std::pair{8u, 10}, std::pair{1u, 20}, std::pair{2u, 5}}) {
        SCOPED_TRACE(fmt::format("{}: leaf {}, depth {}", traversal, leaf, depth));
        const auto structure = octree(*scene, leaf, depth, traversal);
        expect_the_truth(*scene, *structure, adversarial_rays(5, 400, *scene));
        expect_the_truth(*scene, *structure, rays_on_cell_planes(6, 300, *scene));
        if (HasFatalFailure()) return;
      }
}

/// The box is [0, 1]^3 or [-1, 1]^3, so that middle planes are floats that rays can lie in exactly.
TEST(Octree, LosesNothingOnPlanesThatFloatsCanName) {
  Random random(7);
  for (const float low : {0.0f, -1.0f}) {
    SceneData data;
    const auto lattice = [&](std::uint32_t n) { return low + (1 - low) * static_cast<float>(n) * 0.125f; };
    for (std::uint32_t i = 0; i < 60; ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        const float x = lattice(random.below(9)), y = lattice(random.below(9));
        data.vertices.push_back({x, y, lattice(random.below(9))});
      }
      data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    data.vertices[0] = {low, low, low};
    data.vertices[1] = {1, 1, 1};
    const Scene scene{std::move(data)};
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i) {
      constexpr float components[] = {-1, -0.0f, 0.0f, 1};
      Ray ray;
      for (int axis = 0; axis < 3; ++axis) {
        ray.origin[axis] = lattice(random.below(9));
        ray.direction[axis] = components[random.below(4)];
      }
      if (i % 3 != 0) ray.origin = ray.origin - 2.0f * ray.direction;
      rays.push_back(ray);
    }
    for (const char* traversal : traversals) expect_the_truth(scene, *octree(scene, 2, 6, traversal), rays);
  }
}

TEST(Octree, AnswersAtEveryScaleAndFarFromZero) {
  struct Move {
    float factor;
    Vec3 shift;
  };
  const Move moves[] = {{1e-18f, {}}, {1e-6f, {}},           {1e3f, {}},
                        {1e12f, {}},  {1, {1000, -2000, 0}}, {1e-3f, {10, 0, -10}}};
  const Scene scene = mixed_scene(11, 60, 30);
  const std::vector<Ray> unmoved = adversarial_rays(12, 300, scene);
  for (const auto& [factor, shift] : moves) {
    const Scene there = moved(scene, factor, shift);
    std::vector<Ray> rays = unmoved;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      rays[i].origin = factor * rays[i].origin + shift;
      if (i % 2 == 0) rays[i].direction = factor * rays[i].direction;
    }
    for (const char* traversal : traversals) {
      SCOPED_TRACE(fmt::format("{} times {}", traversal, factor));
      expect_the_truth(there, *octree(there, 2, 8, traversal), rays);
    }
  }
}

TEST(Octree, CountsByHandInEightCells) {
  // The root holds two triangles, one too many: of its children the first and the last hold one each.
  const Scene scene = triangle_scene({low_corner, high_corner});
  const std::vector<Ray> rays{
      // Hits the first triangle at t = 1, in the first child, which it leaves at t = 1.5: over. Steps: root,
      // leaf.
      {{0.02f, 0.02f, -1}, 0, {0, 0, 1}},
      // Misses it: then the empty child above.
      {{0.25f, 0.25f, -1}, 0, {0, 0, 1}},
      // Crosses the middle planes of x, y, z in that order: children 0, 1, 3, 7, and misses both triangles.
      {{0.1f, 0, -0.1f}, 0, {1, 1, 1}},
      // The same backwards, from outside: children 7, 3, 1, 0.
      {{1.3f, 1.2f, 1.1f}, 0, {-1, -1, -1}},
      // Ends in the first child, at z = 0.4.
      {{0.25f, 0.25f, -1}, 0, {0, 0, 1}, 1.4f},
      // Begins in the child above and goes up; -0 is no direction.
      {{0.25f, 0.25f, 0.6f}, 0, {-0.0f, 0, 1}},
      // Passes the box; points to nothing; starts too far away (tests everything without a step).
      {{2, 2, -1}, 0, {0, 0, 1}},
      {{0.25f, 0.25f, -1}, 0, {0, 0, 0}},
      {{0.25f, 0.25f, -1e6f}, 0, {0, 0, 1}},
  };
  struct Expected {
    std::uint32_t cells, empty, tests, glassner_steps, top_down_steps;
  };
  const Expected expected[] = {{1, 0, 1, 2, 2}, {2, 1, 1, 4, 3}, {4, 2, 2, 8, 5},
                               {4, 2, 2, 8, 5}, {1, 0, 1, 2, 2}, {1, 1, 0, 2, 2},
                               {0, 0, 0, 0, 0}, {0, 0, 0, 0, 0}, {0, 0, 2, 0, 0}};
  for (const char* traversal : traversals) {
    const auto structure = octree(scene, 1, 3, traversal);
    const StructureStats stats = structure->stats();
    EXPECT_EQ(stats.cells, 8u);
    EXPECT_EQ(stats.empty_cells, 6u);
    EXPECT_EQ(stats.inner_nodes, 1u);
    EXPECT_EQ(stats.references, 2u);
    EXPECT_EQ(stats.depth, 1u);
    EXPECT_EQ(stats.resolution, (std::array<std::uint32_t, 3>{2, 2, 2}));
    EXPECT_EQ(stats.note, "");

    const auto counters = count_closest(*structure, rays).counters;
    const bool glassner = traversal == traversals[0];
    for (std::size_t i = 0; i < rays.size(); ++i) {
      SCOPED_TRACE(fmt::format("{}: ray {}", traversal, i));
      EXPECT_EQ(counters[i].cell_steps, expected[i].cells);
      EXPECT_EQ(counters[i].empty_cell_steps, expected[i].empty);
      EXPECT_EQ(counters[i].tests, expected[i].tests);
      EXPECT_EQ(counters[i].distinct_tests, expected[i].tests);
      EXPECT_EQ(counters[i].steps, glassner ? expected[i].glassner_steps : expected[i].top_down_steps);
      EXPECT_EQ(counters[i].point_locations, glassner ? expected[i].cells : 0);
      EXPECT_EQ(counters[i].subgrids_entered, 0u);
    }
  }
}

TEST(Octree, CountsByHandOnTwoLevels) {
  // The first child of the root holds two triangles and is split too.
  const Scene scene = triangle_scene({low_corner, high_corner, middle});
  // Along z through the first child's children 3 (empty) and 7 (one test), then the root's child 4 (empty).
  const std::vector<Ray> rays{{{0.35f, 0.35f, -1}, 0, {0, 0, 1}}};
  for (const char* traversal : traversals) {
    const auto structure = octree(scene, 1, 2, traversal);
    const StructureStats stats = structure->stats();
    EXPECT_EQ(stats.cells, 15u);
    EXPECT_EQ(stats.empty_cells, 12u);
    EXPECT_EQ(stats.inner_nodes, 2u);
    EXPECT_EQ(stats.references, 3u);
    EXPECT_EQ(stats.depth, 2u);
    const RayCounters counters = count_closest(*structure, rays).counters[0];
    EXPECT_EQ(counters.cell_steps, 3u);
    EXPECT_EQ(counters.empty_cell_steps, 2u);
    EXPECT_EQ(counters.tests, 1u);
    // Down from the root to each leaf: 2 + 2 + 1 inner nodes; top-down sees each of the two once.
    EXPECT_EQ(counters.steps, traversal == traversals[0] ? 3u + 5u : 3u + 2u);
    EXPECT_EQ(counters.point_locations, traversal == traversals[0] ? 3u : 0u);
  }
}

TEST(Octree, CostsWhatASlowWalkerSays) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Scene scene = mixed_scene(seed + 100, 40, 15);
    const std::uint32_t leaf = 1 + static_cast<std::uint32_t>(seed % 5);
    const int depth = 2 + static_cast<int>(seed % 3);
    const SlowOctree slow(scene, leaf, depth);
    const std::vector<Ray> rays = random_rays(seed, 600);
    for (const char* traversal : traversals) {
      SCOPED_TRACE(fmt::format("scene {}, {}", seed, traversal));
      const auto structure = octree(scene, leaf, depth, traversal);
      const SlowOctree::Totals totals = slow.totals();
      const StructureStats stats = structure->stats();
      ASSERT_EQ(stats.cells, totals.leaves);
      EXPECT_EQ(stats.empty_cells, totals.empty);
      EXPECT_EQ(stats.inner_nodes, totals.inner);
      EXPECT_EQ(stats.references, totals.references);
      EXPECT_EQ(stats.depth, totals.depth);

      std::vector<RayCounters> any_counters(rays.size());
      std::vector<std::uint8_t> occluded(rays.size());
      const auto counters = count_closest(*structure, rays).counters;
      structure->count_any({rays, QueryKind::any}, occluded, any_counters);
      for (std::size_t i = 0; i < rays.size(); ++i)
        for (const QueryKind query : {QueryKind::closest, QueryKind::any}) {
          const SlowOctree::Costs costs = slow.costs(rays[i], query);
          if (costs.close_call) continue;
          ++compared;
          const RayCounters& want = traversal == traversals[0] ? costs.glassner : costs.top_down;
          const RayCounters& have = query == QueryKind::closest ? counters[i] : any_counters[i];
          ASSERT_EQ(have.cell_steps, want.cell_steps) << i;
          ASSERT_EQ(have.empty_cell_steps, want.empty_cell_steps) << i;
          ASSERT_EQ(have.steps, want.steps) << i;
          ASSERT_EQ(have.tests, want.tests) << i;
          ASSERT_EQ(have.distinct_tests, want.distinct_tests) << i;
          ASSERT_EQ(have.point_locations, want.point_locations) << i;
        }
    }
  }
  EXPECT_GT(compared, 45000u);  // of 48,000
}

TEST(Octree, CoincidentTrianglesTakeBoundedMemory) {
  // Splitting never separates them, yet always finds children that hold none: only the limit ends it.
  SceneData data;
  data.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  data.triangles.assign(100000, {0, 1, 2});
  const Scene scene{std::move(data)};
  const std::vector<Ray> rays{{{0.25f, 0.25f, -1}, 0, {0, 0, 1}}};
  const auto structure = octree(scene, 8, 20, "glassner");
  const StructureStats stats = structure->stats();
  EXPECT_LE(stats.references, 32 * 100000u + 65536);
  EXPECT_LT(stats.peak_bytes, 60'000'000u);
  EXPECT_THAT(stats.note, testing::HasSubstr("not split"));
  EXPECT_EQ(closest(*structure, rays)[0], (Hit{1, 0}));
}

/// Where all eight children would hold everything, splitting would be of no use.
TEST(Octree, KeepsACellWholeWhereSplittingSeparatesNothing) {
  SceneData data;
  for (int i = 0; i < 20; ++i) data.quadrics.push_back({QuadricKind::sphere, {0, 0, 0}, 1, {}, 0});
  const Scene scene{std::move(data)};
  const StructureStats stats = octree(scene, 8, 1, "glassner")->stats();
  EXPECT_EQ(stats.cells, 1u);
  EXPECT_EQ(stats.references, 20u);
  EXPECT_EQ(stats.note, "");
}

TEST(Octree, BuildsOverNothingOverOneAndOverAFlatScene) {
  const Scene nothing{SceneData{}};
  const Scene one = triangle_scene({middle});
  SceneData data;
  for (std::uint32_t y = 0; y <= 40; ++y)
    for (std::uint32_t x = 0; x <= 40; ++x) data.vertices.push_back({float(x), float(y), 3});
  for (std::uint32_t v = 0; v < 41 * 40; ++v)
    if (v % 41 != 40) {
      data.triangles.push_back({v, v + 1, v + 41});
      data.triangles.push_back({v + 1, v + 42, v + 41});
    }
  const Scene flat{std::move(data)};
  for (const char* traversal : traversals) {
    const auto empty_tree = octree(nothing, 8, 10, traversal);
    EXPECT_EQ(empty_tree->stats().cells, 0u);
    EXPECT_FALSE(closest(*empty_tree, std::vector<Ray>{{{0, 0, 0}, 0, {0, 0, 1}}})[0].found());

    const auto one_cell = octree(one, 1, 20, traversal);
    EXPECT_EQ(one_cell->stats().cells, 1u);
    EXPECT_EQ(one_cell->stats().references, 1u);
    expect_the_truth(one, *one_cell, adversarial_rays(1, 300, one));

    const auto flat_tree = octree(flat, 8, 20, traversal);
    EXPECT_LT(flat_tree->stats().references, 10u * 3200u);
    EXPECT_EQ(flat_tree->stats().note, "");
    expect_the_truth(flat, *flat_tree, adversarial_rays(2, 100, flat));
  }
}

TEST(Octree, KeepsToItsMemoryLimitAndCountsItsBytes) {
  const Scene scene = mixed_scene(21, 2000, 0);
  for (const char* traversal : traversals) {
    const StructureStats stats = octree(scene, 4, 10, traversal)->stats();
    std::uint64_t sum = 0;
    for (const auto& [part, bytes] : stats.bytes_by_part) sum += bytes;
    EXPECT_EQ(sum, stats.bytes);
    EXPECT_GE(stats.peak_bytes, stats.bytes);
    EXPECT_NO_THROW(octree(scene, 4, 10, traversal, stats.peak_bytes));
    EXPECT_THROW(octree(scene, 4, 10, traversal, stats.peak_bytes - 1), MemoryLimitExceeded);
    EXPECT_THROW(octree(scene, 4, 10, traversal, 10), MemoryLimitExceeded);
  }
}

}  // namespace
}  // namespace raymeter
