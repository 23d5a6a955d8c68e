#include "baselines/brute_force.h"

#include <gtest/gtest.h>

#include "scenes/geometry/decide.h"
#include "tests/baselines/test_rays.h"

namespace raymeter {
namespace {

Hit decided(const Scene& scene, const Ray& ray) {
  Hit best;
  for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive) {
    const float t = scene.visit(primitive, [&](const auto& shape) { return decide(ray, shape); });
    if (t != no_hit && Hit{t, primitive} < best) best = {t, primitive};
  }
  return best;
}

TEST(BruteForce, IsTheLeastOfWhatDecideSays) {
  const std::uint32_t sizes[][2] = {{0, 0}, {1, 0}, {0, 1}, {40, 20}, {1100, 0}, {700, 400}};
  for (const auto& [triangles, quadrics] : sizes) {
    const Scene scene = mixed_scene(triangles + 1, triangles, quadrics);
    const auto structure = build("brute-force", scene);
    std::vector<Ray> rays = adversarial_rays(2, 300, scene);
    const auto plain = random_rays(3, 300);
    rays.insert(rays.end(), plain.begin(), plain.end());

    const auto hits = closest(*structure, rays);
    const auto occluded = any(*structure, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Hit truth = decided(scene, rays[i]);
      ASSERT_EQ(hits[i].t, truth.t) << i;
      ASSERT_EQ(hits[i].primitive, truth.primitive) << i;
      ASSERT_EQ(occluded[i], truth.found()) << i;
    }
  }
}

TEST(BruteForce, CountsEveryTest) {
  const Scene scene = mixed_scene(5, 30, 12);
  const auto structure = build("brute-force", scene);
  std::vector<Ray> rays = random_rays(6, 200);
  rays[7].direction = {};
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  std::vector<RayCounters> counters(rays.size()), any_counters(rays.size());
  structure->count_closest({rays}, hits, counters);
  structure->count_any({rays, QueryKind::any}, occluded, any_counters);
  EXPECT_EQ(hits, closest(*structure, rays));
  EXPECT_EQ(occluded, any(*structure, rays));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(counters[i].tests, i == 7 ? 0u : 42u);
    EXPECT_EQ(counters[i].distinct_tests, counters[i].tests);
    EXPECT_EQ(counters[i].steps, 0u);
    if (occluded[i])
      EXPECT_LE(any_counters[i].tests, 42u);
    else
      EXPECT_EQ(any_counters[i].tests, counters[i].tests);
  }
}

}  // namespace
}  // namespace raymeter
