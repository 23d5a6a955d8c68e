#include "harness/ray_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "harness/camera_rays.h"
#include "harness/ray_kinds.h"
#include "harness/ray_origin.h"
#include "scenes/base/error.h"
#include "scenes/generators/generators.h"
#include "tests/harness/closest_hits.h"

namespace raymeter {
namespace {

/// A fixed soup with its own camera and two lights, so that no default moves the expected hashes.
const Scene& soup() {
  static const Scene scene = [] {
    const SceneGenerator& generator = scene_generators()[0];
    SceneData data =
        generator.make(Arguments(parse_spec("soup:triangles=500:size=0.1:seed=3"), generator.parameters));
    data.camera = Camera{{1.5f, 1.25f, 3}, {0.5f, 0.5f, 0.5f}, {0, 1, 0}, 35};
    data.lights = {{{2, 3, 2}, {1, 1, 1}}, {{0.5f, 0.5f, 0.5f}, {1, 1, 1}}};
    return Scene(std::move(data));
  }();
  return scene;
}

BatchSettings small(RayOrder order = RayOrder::tiled) {
  return {.size = {40, 30}, .order = order};
}

struct Primary {
  explicit Primary(const BatchSettings& s)
      : settings(s), batch(make_primary(soup(), s)), hits(closest_hits_by_brute_force(soup(), batch)) {}
  RayBatch secondary(std::string_view kind) const {
    return make_batch(soup(), ray_arguments(parse_spec(kind)), settings, batch, hits);
  }
  std::size_t found() const {
    return static_cast<std::size_t>(std::ranges::count_if(hits, [](const Hit& h) { return h.found(); }));
  }
  BatchSettings settings;
  RayBatch batch;
  std::vector<Hit> hits;
};

const Primary& tiled() {
  static const Primary primary(small());
  return primary;
}

std::vector<std::string> sorted_bytes(const RayBatch& batch) {
  std::vector<std::string> all;
  for (const Ray& ray : batch.rays) all.emplace_back(reinterpret_cast<const char*>(&ray), sizeof ray);
  std::ranges::sort(all);
  return all;
}

TEST(RayBatch, HashesAreTheSameOnEveryMachine) {
  EXPECT_EQ(tiled().batch.hash, 12177067328029118132u);
  EXPECT_EQ(tiled().secondary("shadow").hash, 6346688157290227686u);
  EXPECT_EQ(tiled().secondary("reflection").hash, 12271449228314344086u);
  EXPECT_EQ(tiled().secondary("diffuse").hash, 15394076118459778230u);
  EXPECT_EQ(tiled().secondary("ao").hash, 11926102085321588829u);
  EXPECT_EQ(tiled().secondary("random").hash, 13042291234176920256u);
  EXPECT_EQ(Primary(small(RayOrder::shuffled)).secondary("shadow").hash, 14122372163791593380u);
}

TEST(RayBatch, CountsNamesAndQueries) {
  const std::size_t found = tiled().found();
  ASSERT_GT(found, 300u);
  EXPECT_EQ(tiled().batch.rays.size(), 1200u);
  EXPECT_EQ(tiled().batch.name, "primary");
  EXPECT_EQ(tiled().secondary("shadow").rays.size(), 2 * found);
  EXPECT_EQ(tiled().secondary("reflection").rays.size(), found);
  EXPECT_EQ(tiled().secondary("diffuse:samples=3").rays.size(), 3 * found);
  EXPECT_EQ(tiled().secondary("random").rays.size(), 1200u);
  EXPECT_EQ(tiled().secondary("random").name, "random:count=1200");
  EXPECT_EQ(tiled().secondary("random:count=17").rays.size(), 17u);
  const RayBatch ao = tiled().secondary("ao:samples=2");
  EXPECT_EQ(ao.rays.size(), 2 * found);
  EXPECT_EQ(ao.name, "ao:length=0.05:samples=2");
  EXPECT_EQ(ao.query, QueryKind::any);
  EXPECT_FALSE(ao.coherent);
  EXPECT_TRUE(tiled().secondary("shadow").coherent);
  EXPECT_EQ(tiled().secondary("primary").hash, tiled().batch.hash);
  for (const RayKind& kind : ray_kinds()) {
    if (!kind.query) continue;  // whitted makes several batches
    for (const Ray& ray : tiled().secondary(kind.name).rays) ASSERT_TRUE(is_traceable(ray));
  }
}

TEST(RayBatch, EveryOrderHasTheSameRays) {
  const Primary scanline(small(RayOrder::scanline)), shuffled(small(RayOrder::shuffled));
  for (const RayKind& kind : ray_kinds()) {
    if (!kind.query) continue;  // whitted makes several batches
    const RayBatch expected = tiled().secondary(kind.name);
    for (const Primary* other : {&scanline, &shuffled}) {
      const RayBatch batch = other->secondary(kind.name);
      EXPECT_EQ(sorted_bytes(batch), sorted_bytes(expected)) << kind.name;
      EXPECT_EQ(batch.hash == expected.hash, kind.name == "random") << kind.name;
    }
  }
}

TEST(RayBatch, SeedsDiffer) {
  BatchSettings settings = small();
  settings.seed = 2;
  const Primary other(settings);
  EXPECT_EQ(other.batch.hash, tiled().batch.hash);
  for (const char* kind : {"diffuse", "ao", "random"})
    EXPECT_NE(other.secondary(kind).hash, tiled().secondary(kind).hash);
}

TEST(RayBatch, ShadowRaysEndShortOfTheirLight) {
  const RayBatch shadow = tiled().secondary("shadow");
  const std::size_t found = tiled().found();
  for (std::size_t i = 0; i < shadow.rays.size(); ++i) {
    const Ray& ray = shadow.rays[i];
    const Vec3d light = to_double(soup().lights()[i < found ? 0 : 1].position);
    EXPECT_LT(length(to_double(ray.origin) + to_double(ray.direction) - light), 1e-6);
    EXPECT_EQ(ray.tfar, 0.99999904632568359375f);
  }
}

TEST(RayBatch, ReflectionsMirror) {
  const RayBatch reflection = tiled().secondary("reflection");
  std::size_t next = 0;
  for (std::size_t i = 0; i < tiled().hits.size(); ++i) {
    if (!tiled().hits[i].found()) continue;
    const Vec3d in = to_double(tiled().batch.rays[i].direction);
    const Vec3d out = to_double(reflection.rays[next++].direction);
    const Vec3d n = soup().geometric_normal(tiled().hits[i].primitive, {});
    EXPECT_NEAR(dot(out, n), -dot(in, n), 1e-6);
    EXPECT_NEAR(length(cross(n, out - in)), 0, 1e-6);
    EXPECT_NEAR(length(out), 1, 1e-6);
  }
}

TEST(RayBatch, BouncesAreCosineWeighted) {
  const RayBatch diffuse = tiled().secondary("diffuse:samples=50");
  double sum = 0, squares = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < tiled().hits.size(); ++i) {
    const auto start = leave_surface(soup(), tiled().batch.rays[i], tiled().hits[i]);
    if (!start) continue;
    for (int sample = 0; sample < 50; ++sample) {
      const double cosine = dot(to_double(diffuse.rays[next++].direction), start->normal);
      ASSERT_GT(cosine, 0);
      sum += cosine;
      squares += cosine * cosine;
    }
  }
  const auto n = static_cast<double>(next);
  // Of density 2c on 0..1: mean 2/3, mean square 1/2, within four standard errors.
  EXPECT_NEAR(sum / n, 2.0 / 3, 4 * 0.236 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 0.5, 4 * 0.289 / std::sqrt(n));
}

TEST(RayBatch, AmbientOcclusionIsDiffuseOfBoundedLength) {
  const RayBatch diffuse = tiled().secondary("diffuse"), ao = tiled().secondary("ao:length=0.25");
  ASSERT_EQ(diffuse.rays.size(), ao.rays.size());
  for (std::size_t i = 0; i < ao.rays.size(); ++i) {
    EXPECT_EQ(ao.rays[i].direction, diffuse.rays[i].direction);
    EXPECT_EQ(ao.rays[i].tfar, static_cast<float>(0.25 * soup().bounds().diagonal()));
  }
}

TEST(RayBatch, NoBounceHitsTheTriangleItLeaves) {
  for (const char* kind : {"diffuse:samples=10", "reflection"}) {
    const RayBatch batch = tiled().secondary(kind);
    const std::size_t samples = batch.rays.size() / tiled().found();
    std::size_t next = 0;
    for (const Hit& hit : tiled().hits)
      for (std::size_t sample = 0; hit.found() && sample < samples; ++sample)
        ASSERT_EQ(decide(batch.rays[next++], soup().triangle(hit.primitive)), no_hit);
  }
}

TEST(RayBatch, ChordsAreUniform) {
  // The mean chord of a convex body is 4 V / S (Cauchy): 2/3 of the unit cube, and of isotropic uniform
  // lines through its sphere, surface 3 pi, the part that meets the cube is 6 / (3 pi).
  SceneData data;
  data.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  data.triangles = {{0, 1, 2}, {1, 2, 3}, {4, 5, 6}, {5, 6, 7}, {0, 1, 4}, {1, 4, 5},
                    {2, 3, 6}, {3, 6, 7}, {0, 2, 4}, {2, 4, 6}, {1, 3, 5}, {3, 5, 7}};
  const Scene cube(std::move(data));
  const BatchSettings settings{.size = {1, 1}};
  const RayBatch primary = make_primary(cube, settings);
  const RayBatch chords = make_batch(cube, ray_arguments(parse_spec("random:count=20000")), settings, primary,
                                     closest_hits_by_brute_force(cube, primary));
  double sum = 0;
  int meeting = 0;
  for (const Ray& ray : chords.rays) {
    const float enter = closest_hit_by_brute_force(cube, ray).t;
    if (enter == no_hit) continue;
    Ray rest = ray;
    rest.tnear = enter;
    const float leave = closest_hit_by_brute_force(cube, rest).t;
    if (leave == no_hit) continue;
    ++meeting;
    sum += double(leave) - double(enter);
  }
  EXPECT_NEAR(meeting / 20000.0, 6 / (3 * 3.14159265), 0.015);
  EXPECT_NEAR(sum / meeting, 2.0 / 3, 0.015);
}

TEST(RayBatch, PixelCornersSeeASphereAsLargeAsItIs) {
  SceneData data;
  data.quadrics = {{QuadricKind::sphere, {0, 0, 0}, 1, {}, 0}};
  data.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 45};
  const Scene scene(std::move(data));
  const BatchSettings settings{.size = {128, 128, true}};
  const RayBatch batch = make_primary(scene, settings);
  ASSERT_EQ(batch.rays.size(), 129u * 129u);
  std::size_t hits = 0, expected = 0;
  for (const Ray& ray : batch.rays) hits += decide(ray, scene.quadric(0)) != no_hit;
  // Rays at slope s meet the sphere where sin^2 = s^2 / (1 + s^2) <= 1 / 16, so s^2 <= 1 / 15.
  const double pixel = 2 * std::tan(3.14159265358979 / 8) / 128;
  for (int x = -64; x <= 64; ++x)
    for (int y = -64; y <= 64; ++y) expected += (x * x + y * y) * pixel * pixel <= 1.0 / 15;
  EXPECT_EQ(hits, expected);
}

TEST(RayBatch, EmptyAndImpossiblePictures) {
  BatchSettings away = small();
  away.camera = Camera{{0, 0, 5}, {0, 0, 9}, {0, 1, 0}, 35};
  const Primary primary(away);
  ASSERT_EQ(primary.found(), 0u);
  for (const char* kind : {"shadow", "reflection", "diffuse", "ao"})
    EXPECT_TRUE(primary.secondary(kind).rays.empty());
  EXPECT_EQ(primary.secondary("random").rays.size(), 1200u);

  EXPECT_THROW(make_primary(soup(), {.size = {0, 5}}), Error);
  EXPECT_THROW(make_primary(soup(), {.size = {0xffffffff, 1, true}}), Error);
  EXPECT_THROW(make_primary(soup(), {.size = {0xffffffff, 0xffffffff, true}}), Error);
  away.camera->up = {0, 0, 2};
  EXPECT_THROW(make_primary(soup(), away), Error);
  away.camera = soup().camera();
  away.camera->angle = 180;
  EXPECT_THROW(make_primary(soup(), away), Error);
}

}  // namespace
}  // namespace raymeter
