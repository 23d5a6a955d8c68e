#include "harness/ray_origin.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>

#include "scenes/base/random.h"
#include "scenes/geometry/decide.h"

namespace raymeter {
namespace {

using Exact = boost::multiprecision::cpp_rational;

Vector3<Exact> exact(const Vec3& v) {
  return {Exact(v.x), Exact(v.y), Exact(v.z)};
}

/// On which side of the triangle's plane p lies: -1, 0, 1.
int side(const Triangle& t, const Vec3& p) {
  const auto a = exact(t.a);
  return dot(cross(exact(t.b) - a, exact(t.c) - a), exact(p) - a).sign();
}

Vec3 random_point(Random& random, float size) {
  const float x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}

Scene scene_of(const Triangle& t) {
  SceneData data;
  data.vertices = {t.a, t.b, t.c};
  data.triangles = {{0, 1, 2}};
  data.camera = Camera{{0, 0, 1}, {0, 0, 0}};
  data.lights = {{}};
  return Scene(std::move(data));
}

Scene scene_of(const Quadric& q) {
  SceneData data;
  data.quadrics = {q};
  return Scene(std::move(data));
}

/// A ray from `origin` through a random point of the triangle.
Ray ray_at(const Triangle& t, const Vec3& origin, Random& random) {
  float u = random.uniform(), v = random.uniform();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3 target = t.a + u * (t.b - t.a) + v * (t.c - t.a);
  return {origin, 0, target - origin};
}

TEST(LeaveSurface, StaysOnTheViewersSideOfTriangles) {
  Random random(1);
  int hits = 0;
  for (const float offset : {0.0f, 1.0f, 1e3f, 1e6f})
    for (const float flatness : {1.0f, 1e-3f, 1e-6f})
      for (int i = 0; i < 200; ++i) {
        const Vec3 place{offset, -offset, 0.5f * offset};
        // Slivers: the third corner lies close to the edge of the other two.
        Triangle t{place + random_point(random, 1), place + random_point(random, 1), {}};
        t.c = 0.5f * (t.a + t.b) + flatness * random_point(random, 1);
        const Ray ray = ray_at(t, place + random_point(random, 10), random);
        const Scene scene = scene_of(t);
        const Hit hit{decide(ray, t), 0};
        if (hit.t == no_hit) continue;
        ++hits;
        const auto start = leave_surface(scene, ray, hit);
        ASSERT_TRUE(start);
        ASSERT_EQ(side(t, start->origin), side(t, ray.origin)) << offset << ' ' << flatness << ' ' << i;
        // Close to the surface, for what is far away.
        const Vec3d p = to_double(ray.origin) + double(hit.t) * to_double(ray.direction);
        EXPECT_LT(length(to_double(start->origin) - p), 1e-6 * (length(p) + 20));
      }
  EXPECT_GT(hits, 1500);
}

TEST(LeaveSurface, NoRayToTheViewersSideHitsTheSurfaceItLeaves) {
  Random random(2);
  for (const float offset : {0.0f, 1e6f})
    for (int i = 0; i < 300; ++i) {
      const Vec3 place{offset, offset, offset};
      const float size = offset == 0 ? 1 : 100;
      const Triangle t{place + random_point(random, size), place + random_point(random, size),
                       place + random_point(random, size)};
      const Ray ray = ray_at(t, place + random_point(random, 3 * size), random);
      const float hit = decide(ray, t);
      if (hit == no_hit) continue;
      const auto start = leave_surface(scene_of(t), ray, {hit, 0});
      ASSERT_TRUE(start);
      for (int k = 0; k < 20; ++k) {
        Vec3d direction = to_double(random_point(random, 1));
        const double cosine = dot(direction, start->normal);
        if (cosine < 0) direction = direction - (2 * cosine) * start->normal;
        if (std::abs(cosine) < 1e-6) continue;
        EXPECT_EQ(decide({start->origin, 0, to_float(direction)}, t), no_hit);
      }
    }
}

TEST(LeaveSurface, StaysOnTheViewersSideOfQuadrics) {
  Random random(3);
  int from_outside = 0, from_inside = 0;
  for (const float offset : {0.0f, 10.0f, 1e3f})
    for (int i = 0; i < 6000; ++i) {
      const Vec3 place{offset, offset, -offset};
      Quadric q;
      q.base = place + random_point(random, 1);
      q.base_radius = random.uniform(0.1f, 1);
      if (i % 3) {
        q.kind = i % 3 == 1 ? QuadricKind::cylinder : QuadricKind::cone;
        q.apex = place + random_point(random, 1);
        q.apex_radius = i % 3 == 1 ? q.base_radius : random.uniform(0, 0.1f);
      }
      const Vec3 from = place + random_point(random, 1.5f);
      const Ray ray{from, 0, q.base + random_point(random, 0.5f) - from};
      const Hit hit{decide(ray, q), 0};
      if (hit.t == no_hit) continue;
      const Scene scene = scene_of(q);
      const auto start = leave_surface(scene, ray, hit);
      ASSERT_TRUE(start);
      const Vec3d p = to_double(ray.origin) + double(hit.t) * to_double(ray.direction);
      const Vec3d outward = scene.geometric_normal(0, p);
      const bool outside = dot(outward, start->normal) > 0;
      ++(outside ? from_outside : from_inside);
      EXPECT_LE(dot(start->normal, to_double(ray.direction)), 0);
      // The way on, out of the surface: from outside never back into it at once.
      const float next = decide({start->origin, 0, to_float(start->normal)}, q);
      EXPECT_TRUE(next == no_hit || next > 1e-5f * (1 + offset)) << next;
      if (q.kind != QuadricKind::sphere) continue;
      if (outside) {
        EXPECT_EQ(next, no_hit);
      } else {
        EXPECT_NEAR(next, 2 * q.base_radius, 1e-5 * (1 + offset));
      }
    }
  EXPECT_GT(from_outside, 500);
  EXPECT_GT(from_inside, 500);
}

TEST(LeaveSurface, StaysOutsideSpheresNearlyAsSmallAsTheRoundingOfTheirPlace) {
  Random random(4);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Quadric sphere{QuadricKind::sphere,
                         Vec3{100, 200, -50} + random_point(random, 1),
                         random.uniform(1e-5f, 1e-4f),
                         {},
                         0};
    const Vec3 from = sphere.base + random_point(random, 1);
    const Ray ray{from, 0, sphere.base + random_point(random, sphere.base_radius) - from};
    const Hit hit{decide(ray, sphere), 0};
    if (hit.t == no_hit) continue;
    ++hits;
    const auto start = leave_surface(scene_of(sphere), ray, hit);
    ASSERT_TRUE(start);
    const auto w = exact(start->origin) - exact(sphere.base);
    ASSERT_GT(dot(w, w), Exact(sphere.base_radius) * Exact(sphere.base_radius)) << i;
  }
  EXPECT_GT(hits, 1000);
}

TEST(LeaveSurface, NothingFromMissesTipsAndBeyondFloat) {
  const Quadric cone{QuadricKind::cone, {0, 0, 0}, 1, {0, 0, 1}, 0};
  EXPECT_FALSE(leave_surface(scene_of(cone), {{0, 0, 3}, 0, {0, 0, -1}}, Hit{}));
  EXPECT_FALSE(leave_surface(scene_of(cone), {{0, 0, 3}, 0, {0, 0, -1}}, Hit{2, 0}));
  const Triangle huge{{3.4e38f, 0, 0}, {3.4e38f, 1e38f, 0}, {3.4e38f, 0, 1e38f}};
  EXPECT_TRUE(leave_surface(scene_of(huge), {{0, 1, 1}, 0, {1, 0, 0}}, Hit{3.4e38f, 0}));
  EXPECT_FALSE(leave_surface(scene_of(huge), {{0, 1, 1}, 0, {3, 0, 0}}, Hit{3.4e38f, 0}));
}

}  // namespace
}  // namespace raymeter
