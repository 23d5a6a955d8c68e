#include "baselines/counted_bvh.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "accel/memory_meter.h"
#include "scenes/base/error.h"
#include "tests/baselines/test_rays.h"
#include "tests/closed_sphere.h"

namespace raymeter {
namespace {

void expect_same_as_brute_force(const std::string& spec, const Scene& scene, std::span<const Ray> rays) {
  const auto structure = build(spec, scene), truth = build("brute-force", scene);
  const auto hits = closest(*structure, rays), expected = closest(*truth, rays);
  EXPECT_EQ(any(*structure, rays), any(*truth, rays)) << spec;
  std::vector<Hit> counted(rays.size());
  std::vector<std::uint8_t> counted_any(rays.size());
  std::vector<RayCounters> counters(rays.size());
  structure->count_closest({rays}, counted, counters);
  structure->count_any({rays, QueryKind::any}, counted_any, counters);
  EXPECT_EQ(counted, hits);
  EXPECT_EQ(counted_any, any(*structure, rays));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    ASSERT_TRUE(std::bit_cast<std::uint32_t>(hits[i].t) == std::bit_cast<std::uint32_t>(expected[i].t) &&
                hits[i].primitive == expected[i].primitive)
        << fmt::format("{}: ray {} from {} {} {} along {} {} {} in {}..{}: {} of {}, should be {} of {}",
                       spec, i, ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                       ray.direction.z, ray.tnear, ray.tfar, hits[i].t, hits[i].primitive, expected[i].t,
                       expected[i].primitive);
  }
}

TEST(CountedBvh, IsBitIdenticalToBruteForce) {
  const std::uint32_t sizes[][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 2}, {60, 20}, {200, 60}};
  std::uint64_t seed = 0;
  for (const auto& [triangles, quadrics] : sizes)
    for (const int branching : {2, 3, 4, 8}) {
      const Scene scene = mixed_scene(++seed, triangles, quadrics);
      const auto spec = fmt::format("counted-bvh:branching={}", branching);
      expect_same_as_brute_force(spec, scene, random_rays(seed, 300));
      expect_same_as_brute_force(spec, scene, adversarial_rays(seed, 700, scene));
    }
  const Scene terrain = terrain_scene(99, 10);
  expect_same_as_brute_force("counted-bvh", terrain, adversarial_rays(100, 1500, terrain));
}

TEST(CountedBvh, TakesCoincidentFlatAndDegeneratePrimitives) {
  SceneData data;
  for (std::uint32_t i = 0; i < 300; ++i) {
    data.vertices.insert(data.vertices.end(), {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    if (i % 3 == 0) data.triangles.push_back({3 * i, 3 * i, 3 * i});
  }
  const Scene scene{std::move(data)};
  for (const int branching : {2, 8}) {
    const auto spec = fmt::format("counted-bvh:branching={}", branching);
    const Ray through{{0.2f, 0.2f, 0}, 0, {0, -0.0f, 1}};
    EXPECT_EQ(closest(*build(spec, scene), {&through, 1})[0], (Hit{1, 0}));
    expect_same_as_brute_force(spec, scene, adversarial_rays(3, 100, scene));
  }
}

/// Two triangles in the planes z = 1 and z = 11, their boxes [0,1]^2 and [0,2]^2.
Scene two_triangles() {
  SceneData data;
  data.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 11}, {2, 0, 11}, {0, 2, 11}};
  data.triangles = {{0, 1, 2}, {3, 4, 5}};
  return Scene(std::move(data));
}

struct Counts {
  std::uint32_t steps, cell_steps, tests;
  friend bool operator==(const Counts&, const Counts&) = default;
};

TEST(CountedBvh, SlowIsWatertight) {
  for (const char* spec : {"counted-bvh", "counted-bvh:branching=2"})
    expect_watertight_everywhere([&](const Scene& scene) { return build(spec, scene); });
}

TEST(CountedBvh, CountsAsByHand) {
  const Scene scene = two_triangles();
  const auto structure = build("counted-bvh", scene);
  const auto stats = structure->stats();
  EXPECT_EQ(stats.inner_nodes, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.references, 2u);
  EXPECT_EQ(stats.depth, 1u);

  const std::vector<Ray> rays{
      {{0.2f, 0.2f, 0}, 0, {0, 0, 1}},        // root, near leaf; its hit hides the far one
      {{0.9f, 0.9f, 0}, 0, {0, 0, 1}},        // root, near leaf (missed), far leaf
      {{1.5f, 0.2f, 0}, 0, {0, 0, 1}},        // root, far leaf
      {{5, 5, 0}, 0, {0, 0, 1}},              // beside everything
      {{0.2f, 0.2f, 0}, 0, {0, 0, 1}, 0.5f},  // ends before everything
      {{0.2f, 0.2f, 5}, 0, {0, 0, 1}},        // root, far leaf
      {{0.2f, 0.2f, 5}, 0, {0, 0, 0}},        // not traceable
  };
  const std::vector<Counts> expected{{2, 1, 1}, {3, 2, 2}, {2, 1, 1}, {0, 0, 0},
                                     {0, 0, 0}, {2, 1, 1}, {0, 0, 0}};
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  std::vector<RayCounters> counters(rays.size()), any_counters(rays.size());
  structure->count_closest({rays}, hits, counters);
  structure->count_any({rays, QueryKind::any}, occluded, any_counters);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (const RayCounters& c : {counters[i], any_counters[i]}) {
      EXPECT_EQ((Counts{c.steps, c.cell_steps, c.tests}), expected[i]) << i;
      EXPECT_EQ(c.distinct_tests, c.tests);
      EXPECT_EQ(c.empty_cell_steps, 0u);
    }
  }
}

TEST(CountedBvh, AccountsForItsMemory) {
  const Scene scene = mixed_scene(4, 3000, 100);
  Registry registry;
  register_baselines(registry);
  const auto stats = registry.build(parse_spec("counted-bvh:branching=4"), {scene})->stats();
  EXPECT_EQ(stats.references, scene.primitive_count());
  EXPECT_EQ(stats.bytes, 32 * (stats.cells + stats.inner_nodes) + 4 * stats.references);
  EXPECT_GT(stats.peak_bytes, stats.bytes);
  for (const std::uint64_t limit :
       {std::uint64_t{0}, std::uint64_t{50000}, stats.bytes, stats.peak_bytes / 2})
    for (const unsigned threads : {1u, 2u})
      EXPECT_THROW(registry.build(parse_spec("counted-bvh"), {scene, threads, limit}), MemoryLimitExceeded);
}

TEST(CountedBvh, TakesCoordinatesBeyondEmbrees) {
  // Half of the triangles at 2^100, half so near the origin that they are flushed where Embree's builder sees
  // them.
  const Scene ordinary = mixed_scene(6, 2000, 0);
  SceneData data;
  data.name = "far and near";
  for (const Vec3& v : ordinary.vertices())
    data.vertices.push_back((data.vertices.size() % 6 < 3 ? 0x1p100f : 0x1p-70f) * v);
  for (std::uint32_t i = 0; i < 2000; ++i) data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  const Scene scene{std::move(data)};
  EXPECT_THROW(build("embree", scene), Error);
  const auto structure = build("counted-bvh", scene);
  for (const float scale : {0x1p100f, 0x1p-70f}) {
    std::vector<Ray> rays = random_rays(7, 3000);
    for (Ray& ray : rays) ray.origin = scale * ray.origin;
    const auto hits = closest(*structure, rays);
    EXPECT_EQ(hits, closest(*build("brute-force", scene), rays));
    EXPECT_GT(std::ranges::count_if(hits, &Hit::found), 500);
  }
}

}  // namespace
}  // namespace raymeter
