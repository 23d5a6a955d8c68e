#include <gmock/gmock.h>

#include "accel/brick_kernels.h"
#include "scenes/open_scene.h"
#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

/// For every instruction set of this CPU.
class BrickPackets : public testing::TestWithParam<const BrickKernels*> {
 protected:
  std::string spec(const std::string& arguments) const {
    return std::string("brick-grid:query=16:isa=") + GetParam()->isa + (arguments.empty() ? "" : ":") +
           arguments;
  }
};

/// Groups of rays that go about the same way as one of hostile_rays, some of which start together, or meet.
std::vector<Ray> hostile_groups(std::uint64_t seed, std::size_t groups, const Scene& scene) {
  Random random(seed);
  const double size = std::max(1e-30, scene.bounds().empty() ? 1 : scene.bounds().diagonal());
  constexpr double spreads[] = {0, 1e-7, 1e-4, 1e-2, 0.3};
  const auto near = [&](const Vec3& p, double reach) {
    Vec3d q = to_double(p);
    for (int axis = 0; axis < 3; ++axis) q[axis] += reach * random.uniform(-1, 1);
    return to_float(q);
  };
  std::vector<Ray> rays;
  for (const Ray& leader : hostile_rays(seed, groups, scene)) {
    const double spread = spreads[random.below(5)] * size, turn = spreads[random.below(5)];
    const Vec3d direction = to_double(leader.direction);
    const double length =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z), 1e-30});
    const Vec3 target = to_float(to_double(leader.origin) + direction);
    const std::uint32_t kind = random.below(4), count = 1 + random.below(20);
    for (std::uint32_t i = 0; i < count; ++i) {
      Ray ray = leader;
      if (kind % 2 == 1) ray.origin = near(leader.origin, spread);
      ray.direction = kind == 3 ? target - ray.origin : near(leader.direction, turn * length);
      // Some keep the leader's zeros.
      for (int axis = 0; axis < 3; ++axis)
        if (leader.direction[axis] == 0 && random.below(2) == 0) ray.direction[axis] = leader.direction[axis];
      switch (random.below(8)) {
        case 0:
          ray.tfar = random.uniform(0, 2);
          break;
        case 1:
          ray.tnear = random.uniform(0, 1);
          break;
        case 2: {
          Hit hit;
          NoProbe probe;
          hit = closest_of_all(scene, ray, probe);
          if (hit.found()) (random.below(2) == 0 ? ray.tfar : ray.tnear) = hit.t;
          break;
        }
        case 3:
          if (random.below(4) == 0) ray = hostile_rays(seed + i, 1, scene).front();
          break;
        default:
          break;
      }
      for (Vec3* v : {&ray.origin, &ray.direction})
        for (int axis = 0; axis < 3; ++axis)
          if (std::abs((*v)[axis]) < std::numeric_limits<float>::min()) (*v)[axis] = 0;
      rays.push_back(ray);
    }
  }
  return rays;
}

TEST_P(BrickPackets, AnswerLikeBruteForce) {
  const std::string specs[] = {spec(""), spec("cells=1:leaf=1"), spec("cells=2x3x1:leaf=2"),
                               spec("density=4:leaf=4")};
  const std::pair<float, Vec3> places[] = {
      {1, {}},      {1, {}},     {1e-3f, {}},          {1e3f, {100, 0, -5000}},
      {1e-12f, {}}, {1e12f, {}}, {1e-2f, {1000, 3, 0}}};
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const auto& [scale, centre] = places[seed % std::size(places)];
    const Scene scene = small_scene(seed, seed % 5 == 0 ? 3 : 30, scale, centre);
    const auto rays = hostile_groups(seed, 12, scene);
    const std::string& s = specs[seed % std::size(specs)];
    ASSERT_NO_FATAL_FAILURE(
        expect_brute_force(*build(s, scene), scene, rays, s + ", seed " + std::to_string(seed)));
  }
}

TEST_P(BrickPackets, AnswerLikeBruteForceInDeepTrees) {
  for (const char* name :
       {"soup:triangles=1500", "clusters:objects=1500", "terrain:triangles=1500", "slivers:triangles=700",
        "stadium:triangles=1500", "clusters:objects=500:primitive=sphere"}) {
    const Scene scene = open_scene(name);
    const auto rays = hostile_groups(3, 40, scene);
    for (const char* arguments : {"", "cells=1", "cells=1:leaf=2", "density=0.5"})
      ASSERT_NO_FATAL_FAILURE(
          expect_brute_force(*build(spec(arguments), scene), scene, rays, spec(arguments) + " on " + name));
  }
}

TEST_P(BrickPackets, AnswerLikeBruteForceToCameras) {
  Random random(4);
  for (const char* name : {"soup:triangles=300", "terrain:triangles=800", "stadium:triangles=800"}) {
    const Scene scene = open_scene(name);
    const auto bricks = build(spec("leaf=8"), scene);
    const Vec3d middle = 0.5 * (to_double(scene.bounds().low) + to_double(scene.bounds().high));
    for (int view = 0; view < 12; ++view) {
      // From outside, from within, and along each axis, where four octants meet.
      const double size = scene.bounds().diagonal(), distance = view % 2 == 0 ? 1.5 : 0.2;
      Vec3d from, aside, up;
      from[view % 3] = view % 4 < 2 ? -1 : 1;
      aside[(view + 1) % 3] = up[(view + 2) % 3] = 0.02;
      if (view >= 6) from = from + Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      const Vec3 eye = to_float(middle + distance * size * from);
      std::vector<Ray> rays, shadows;
      for (int y = -10; y < 10; ++y)
        for (int x = -10; x < 10; ++x)
          rays.push_back({eye, 0, to_float(-1.0 * from + double(x) * aside + double(y) * up)});
      std::vector<Hit> hits(rays.size());
      bricks->trace_closest({rays}, hits);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].found()) continue;
        const Vec3 at = rays[i].origin + hits[i].t * rays[i].direction;
        shadows.push_back({at, 0, to_float(middle + size * Vec3d{0.3, 0.9, 0.2}) - at, 0.999f});
      }
      ASSERT_NO_FATAL_FAILURE(expect_brute_force(*bricks, scene, rays, name));
      ASSERT_NO_FATAL_FAILURE(expect_brute_force(*bricks, scene, shadows, name));
    }
  }
}

TEST_P(BrickPackets, AnswerLikeBruteForceWhereTheyPause) {
  const Scene scene = open_scene("soup:triangles=500");
  const auto rays = hostile_groups(6, 100, scene);
  const auto bricks = build(std::string("brick-grid:leaf=4:isa=") + GetParam()->isa, scene);
  BatchView batch{rays};
  batch.coherent = true;
  std::vector<Hit> hits(rays.size()), singly(rays.size());
  bricks->trace_closest(batch, hits);
  bricks->trace_closest({rays}, singly);
  EXPECT_EQ(hits, singly);
  std::vector<std::uint8_t> occluded(rays.size()), singly_occluded(rays.size());
  bricks->trace_any(batch, occluded);
  bricks->trace_any({rays, QueryKind::any}, singly_occluded);
  EXPECT_EQ(occluded, singly_occluded);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, BrickPackets, testing::ValuesIn(brick_kernels()), [](const auto& test) {
  std::string name = test.param->isa;
  std::erase(name, '.');
  return name;
});

/// What each ray's closest hit costs.
std::vector<RayCounters> count(const Structure& structure, const BatchView& batch) {
  std::vector<RayCounters> counters(batch.rays.size());
  std::vector<Hit> hits(batch.rays.size());
  structure.count_closest(batch, hits, counters);
  return counters;
}

TEST(BrickPacketCounts, AreOfTheRaysThatTakePart) {
  // Two small walls across the x axis, in the first and the last cell of the only brick.
  SceneData data;
  data.name = "corners";
  data.vertices = {{0, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}, {4, 1, 1}, {4, 0.9f, 1}, {4, 1, 0.9f}};
  data.triangles = {{0, 1, 2}, {3, 4, 5}};
  const Scene scene(std::move(data));
  const auto bricks = build("brick-grid:cells=1:leaf=1:query=16", scene);
  // Six rays at either wall, and four that pass beside the scene.
  std::vector<Ray> rays;
  for (int i = 0; i < 16; ++i) {
    const float y = i < 6 ? 0.02f : i < 12 ? 0.98f : 5.0f;
    rays.push_back({{-1, y, i < 6 ? 0.03f : 0.97f}, 0, {1, 0, 0}});
  }
  const auto counters = count(*bricks, {rays});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const RayCounters& c = counters[i];
    // The brick, and a leaf. Each of the walls may be tested against the rays at the other, too.
    EXPECT_EQ(c.steps, i < 12 ? 2u : 0u) << i;
    EXPECT_EQ(c.cell_steps, i < 12 ? 1u : 0u) << i;
    EXPECT_EQ(c.decides, i < 12 ? 1u : 0u) << i;
    EXPECT_GE(c.tests, i < 12 ? 1u : 0u) << i;
    EXPECT_LE(c.tests, i < 12 ? 2u : 0u) << i;
    EXPECT_EQ(c.distinct_tests, c.tests) << i;
  }
}

TEST(BrickPacketCounts, TellWhatIsTracedTogether) {
  const Scene scene = open_scene("terrain:triangles=500");
  const Vec3d middle = 0.5 * (to_double(scene.bounds().low) + to_double(scene.bounds().high));
  const Vec3 eye = to_float(middle + scene.bounds().diagonal() * Vec3d{0, 0, 1});
  Random random(1);
  std::vector<Ray> rays;
  for (int i = 0; i < 64; ++i)
    rays.push_back({eye, 0, {random.uniform(-1e-3f, 1e-3f), random.uniform(-1e-3f, 1e-3f), -1}});
  const auto steps = [&](const char* query, bool coherent) {
    std::uint64_t sum = 0;
    BatchView batch{rays};
    batch.coherent = coherent;
    for (const RayCounters& c : count(*build(std::string("brick-grid:leaf=2:query=") + query, scene), batch))
      sum += c.steps + 1000 * c.tests;
    return sum;
  };
  const std::uint64_t singly = steps("1", false), together = steps("16", true);
  EXPECT_NE(singly, together);
  EXPECT_EQ(steps("1", true), singly);
  EXPECT_EQ(steps("16", false), together);
  EXPECT_EQ(steps("auto", false), singly);
  EXPECT_EQ(steps("auto", true), together);  // the rays meet the same leaves
}

}  // namespace
}  // namespace raymeter
