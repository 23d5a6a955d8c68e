// Scenes at the edge of what can be built: every structure ends, keeps to a bounded amount of memory and
// answers like brute force, or is refused in words.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accel/memory_meter.h"
#include "baselines/register_baselines.h"
#include "scenes/base/error.h"
#include "tests/accel/grid_tests.h"

namespace raymeter {
namespace {

/// Everything that can be built, in the forms that have limits of their own.
const std::vector<std::string> all_specs{"grid",
                                         "tunable-grid:fit=box",
                                         "tunable-grid:density=64:mailbox=on",
                                         "octree",
                                         "octree:leaf=1:depth=20",
                                         "octree:traversal=top-down",
                                         "two-level-grid",
                                         "two-level-grid:threshold=0:leaf-density=50",
                                         "brick-grid",
                                         "brick-grid:cells=1:leaf=1",
                                         "grid:leaf=simd",
                                         "tunable-grid:amount=0.5:leaf=simd",
                                         "two-level-grid:leaf-density=0.5:leaf=simd",
                                         "counted-bvh",
                                         "brute-force"};

std::unique_ptr<Structure> build_any(const std::string& spec, const Scene& scene, unsigned threads = 1) {
  Registry registry;
  register_accel(registry);
  register_baselines(registry);
  return registry.build(parse_spec(spec), {scene, threads, 4'000'000'000});
}

/// At most this many bytes for a scene of so many primitives, while building and after: 2^26 cells, 64
/// references a primitive, and what else there is for each.
std::uint64_t allowed_bytes(std::uint64_t primitives) {
  return 350'000'000 + 1000 * primitives;
}

void expect_bounded_and_right(const Scene& scene, const std::vector<std::string>& specs,
                              std::span<const Ray> batch) {
  for (const std::string& spec : specs) {
    const auto structure = build_any(spec, scene);
    EXPECT_LE(structure->stats().peak_bytes, allowed_bytes(scene.primitive_count())) << spec;
    EXPECT_GE(structure->stats().peak_bytes, structure->stats().bytes) << spec;
    ASSERT_NO_FATAL_FAILURE(expect_brute_force(*structure, scene, batch, scene.name() + ", " + spec));
  }
}

void expect_bounded_and_right(const Scene& scene, const std::vector<std::string>& specs, std::size_t rays) {
  expect_bounded_and_right(scene, specs, hostile_rays(11, rays, scene));
}

SceneData soup_in(const Vec3& low, const Vec3& high, std::uint32_t triangles, std::uint64_t seed = 1) {
  Random random(seed);
  SceneData data;
  const auto point = [&] {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(low[axis], high[axis]);
    return p;
  };
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 centre = point();
    for (int corner = 0; corner < 3; ++corner) data.vertices.push_back(centre + 0.1f * (point() - centre));
    data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return data;
}

Scene named(SceneData data, std::string name) {
  data.name = std::move(name);
  return Scene(std::move(data));
}

TEST(Limits, NothingAndOnePrimitive) {
  expect_bounded_and_right(named({}, "nothing"), all_specs, 50);
  SceneData triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f}};
  triangle.triangles = {{0, 1, 2}};
  expect_bounded_and_right(named(triangle, "one triangle"), all_specs, 200);
  SceneData flat = triangle;
  flat.vertices = {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}};
  expect_bounded_and_right(named(flat, "one flat triangle"), all_specs, 200);
  SceneData sphere;
  sphere.quadrics = {{QuadricKind::sphere, {1, 2, 3}, 0.5f, {}, 0}};
  expect_bounded_and_right(named(sphere, "one sphere"), all_specs, 200);
}

TEST(Limits, BoxesWithoutThickness) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 low{-1, -1, -1}, high{1, 1, 1};
    low[axis] = high[axis] = 0.25f;
    SceneData plane = soup_in(low, high, 300);
    for (Vec3& v : plane.vertices) v[axis] = 0.25f;
    expect_bounded_and_right(named(plane, fmt::format("plane {}", axis)), all_specs, 100);
    // A line: triangles without area, each of which costs exact arithmetic, in a box with one dimension.
    SceneData line = soup_in(low, high, 30);
    for (Vec3& v : line.vertices) v[axis] = 0.25f, v[(axis + 1) % 3] = -2;
    expect_bounded_and_right(named(line, fmt::format("line {}", axis)), all_specs, 20);
  }
  SceneData point;
  point.vertices = {{1, 2, 3}};
  point.triangles.assign(30, {0, 0, 0});
  expect_bounded_and_right(named(point, "point"), all_specs, 50);
}

TEST(Limits, CoordinatesOfEverySize) {
  for (const float scale : {1e-40f, 1e-37f, 1e-30f, 1e-20f, 1e10f, 1e18f, 1e30f}) {
    const SceneData soup = soup_in(scale * Vec3{-1, -1, -1}, scale * Vec3{1, 1, 1}, 200);
    expect_bounded_and_right(named(soup, fmt::format("soup of {:g}", scale)), all_specs, 60);
  }
  // Embree takes none beyond 1.8e18, and says so.
  const Scene huge = named(soup_in({-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}, 200), "soup of 1e30");
  try {
    build_any("embree", huge);
    ADD_FAILURE() << "Embree takes what it can't hold";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("soup of 1e30: coordinates beyond 1.844e+18"));
  }
}

TEST(Limits, SmallBesideLarge) {
  // In one scene: sizes 30 orders of magnitude apart; and a soup far from 0.
  SceneData mixed;
  for (const float scale : {1e-30f, 1e-15f, 1.0f, 1e15f}) {
    const auto first = static_cast<std::uint32_t>(mixed.vertices.size());
    const SceneData part = soup_in({0, 0, 0}, {scale, scale, scale}, 50, 7);
    mixed.vertices.insert(mixed.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (auto t : part.triangles) mixed.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  expect_bounded_and_right(named(mixed, "mixed"), all_specs, 100);
  expect_bounded_and_right(named(soup_in({9999990, 1, 1}, {9999999, 2, 2}, 200), "far"), all_specs, 100);
}

TEST(Limits, GroundAThousandTimesWider) {
  SceneData data = soup_in({-1, -1, 0}, {1, 1, 1}, 3000);
  const auto first = static_cast<std::uint32_t>(data.vertices.size());
  for (const auto& [x, y] : {std::pair{-1e3f, -1e3f}, {1e3f, -1e3f}, {1e3f, 1e3f}, {-1e3f, 1e3f}})
    data.vertices.push_back({x, y, 0});
  data.triangles.push_back({first, first + 1, first + 2});
  data.triangles.push_back({first, first + 2, first + 3});
  const Scene scene = named(data, "stadium");
  expect_bounded_and_right(scene, all_specs, 60);
  EXPECT_THAT(build_any("grid:amount=4", scene)->stats().note, testing::HasSubstr("clamped from"));
}

/// `count` copies of one triangle.
Scene coincident(std::uint32_t count) {
  SceneData data;
  data.vertices = {{0, 0, 0}, {1, 0, 0.5f}, {0, 1, 0.25f}};
  data.triangles.assign(count, {0, 1, 2});
  return named(std::move(data), "coincident");
}

TEST(Limits, SlowCoincidentPrimitivesTakeMemoryInProportion) {
  expect_bounded_and_right(coincident(300), all_specs, 10);
  const Scene scene = coincident(5000), twice = coincident(10000);
  for (const std::string& spec : all_specs) {
    const auto bytes = build_any(spec, scene)->stats().peak_bytes;
    EXPECT_LE(build_any(spec, twice)->stats().peak_bytes, 2 * bytes + allowed_bytes(0)) << spec;
  }
}

TEST(Limits, SlowAMillionCoincidentPrimitives) {
  const Scene scene = coincident(1000000);
  for (const char* spec : {"grid", "octree", "two-level-grid", "brick-grid"}) {
    // On several threads, all of which want the same cells.
    const auto structure = build_any(spec, scene, 4);
    EXPECT_LE(structure->stats().peak_bytes, allowed_bytes(scene.primitive_count())) << spec;
    const Ray ray{{0.25f, 0.25f, 5}, 0, {0, 0, -1}};
    Hit hit;
    structure->trace_closest({{&ray, 1}}, {&hit, 1});
    EXPECT_EQ(hit, (Hit{decide(ray, scene.triangle(0)), 0})) << spec;
  }
}

TEST(Limits, AMemoryLimitIsKeptOrRefusedInWords) {
  const Scene scene = named(soup_in({0, 0, 0}, {1, 1, 1}, 20000), "soup");
  Registry registry;
  register_accel(registry);
  register_baselines(registry);
  for (const std::string& spec : all_specs)
    for (const std::uint64_t limit : {std::uint64_t{1000}, std::uint64_t{1} << 20u, std::uint64_t{1} << 24u})
      try {
        const StructureStats stats = registry.build(parse_spec(spec), {scene, 1, limit})->stats();
        EXPECT_LE(stats.peak_bytes, limit) << spec;
      } catch (const MemoryLimitExceeded& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("are allowed")) << spec;
        EXPECT_TRUE(limit < std::uint64_t{1} << 24u || spec.find("leaf=1") != std::string::npos) << spec;
      }
}

}  // namespace
}  // namespace raymeter
