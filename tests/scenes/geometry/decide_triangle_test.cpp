#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
#include "scenes/geometry/filter.h"
#include "tests/closed_sphere.h"
#include "tests/scenes/geometry/adversary.h"
#include "tests/scenes/geometry/exact_reference.h"

namespace raymeter {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

float decide_flushing(const Ray& ray, const Triangle& triangle) {
  const FlushDenormals mode;
  return decide(ray, triangle);
}

std::string show(const Ray& ray, const Triangle& triangle) {
  std::string text;
  for (const Vec3& v : {ray.origin, ray.direction, triangle.a, triangle.b, triangle.c})
    for (int i = 0; i < 3; ++i) {
      char number[40];
      std::snprintf(number, sizeof number, "%a ", double(v[i]));
      text += number;
    }
  return text + std::to_string(ray.tnear) + " " + std::to_string(ray.tfar);
}

TEST(DecideTriangle, IsTheExactAnswerRounded) {
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto style = adversary::styles[i % std::size(adversary::styles)];
    const Triangle triangle = adversary::triangle(random, style);
    Ray ray = adversary::ray_towards(random, style, adversary::point_on(random, triangle));
    if (random.below(4) == 0) ray.tnear = -infinity;
    adversary::tempt_interval(random, ray, reference::decide(ray, triangle));
    const float truth = reference::decide(ray, triangle);
    hits += truth != no_hit;
    ASSERT_EQ(decide(ray, triangle), truth) << show(ray, triangle);
    ASSERT_EQ(decide_flushing(ray, triangle), truth) << show(ray, triangle);
  }
  EXPECT_GT(hits, 20000);
}

const Triangle floor_at_1{{-1, -1, 1}, {3, -1, 1}, {-1, 3, 1}};

TEST(DecideTriangle, RoundsTiesToEven) {
  const auto from = [](float z) { return decide({{0, 0, z}, 0, {0, 0, 1}}, floor_at_1); };
  EXPECT_EQ(from(-0x1p-24f), 1.0f);
  EXPECT_EQ(from(-0x1.000002p-24f), 1 + 0x1p-23f);
  EXPECT_EQ(from(-0x1.fffffep-25f), 1.0f);
  EXPECT_EQ(from(-0x3p-24f), 1 + 0x2p-23f);
}

TEST(DecideTriangle, RoundsToZeroBelowTheNormalFloatsAndHitsNothingBeyondThem) {
  const auto at = [](float z, float speed, float tnear) {
    const Triangle triangle{{-1, -1, z}, {3, -1, z}, {-1, 3, z}};
    const FlushDenormals mode;
    const float flushing = decide({{0, 0, 0}, tnear, {0, 0, speed}}, triangle);
    EXPECT_EQ(flushing, decide_flushing({{0, 0, 0}, tnear, {0, 0, speed}}, triangle));
    return flushing;
  };
  EXPECT_EQ(at(0x1p-100f, 0x1p26f, 0), 0x1p-126f);
  EXPECT_EQ(at(0x1p-100f, 0x1p27f, -1), 0.0f);
  EXPECT_EQ(at(0x1p-100f, 0x1p27f, 0), no_hit);
  EXPECT_EQ(at(0x1.fffffep-100f, 0x1p27f, -1), 0.0f);
  EXPECT_EQ(at(0x1.fffffep100f, 0x1p-27f, 0), FLT_MAX);
  EXPECT_EQ(at(0x1p101f, 0x1p-27f, 0), no_hit);
  EXPECT_EQ(at(-0x1p101f, 0x1p-27f, -infinity), no_hit);
  EXPECT_EQ(at(1e-40f, 1, -1), 0.0f) << "a denormal counts as zero";
}

TEST(DecideTriangle, IntervalIsOpenAtTnearAndClosedAtTfar) {
  Ray ray{{0, 0, 0}, 0, {0, 0, 0.5f}};
  ray.tfar = 2;
  EXPECT_EQ(decide(ray, floor_at_1), 2.0f);
  ray.tfar = std::nextafter(2.0f, 0.0f);
  EXPECT_EQ(decide(ray, floor_at_1), no_hit);
  ray.tfar = infinity, ray.tnear = 2;
  EXPECT_EQ(decide(ray, floor_at_1), no_hit);
  ray.tnear = std::nextafter(2.0f, 0.0f);
  EXPECT_EQ(decide(ray, floor_at_1), 2.0f);
}

TEST(DecideTriangle, WhatIsNoRayAndWhatIsNoTriangleMisses) {
  const Ray good{{0, 0, 0}, 0, {0, 0, 1}};
  ASSERT_EQ(decide(good, floor_at_1), 1.0f);
  for (const float bad : {infinity, -infinity, std::nanf("")}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray ray = good;
      ray.origin[axis] = bad;
      EXPECT_EQ(decide(ray, floor_at_1), no_hit);
      ray = good, ray.direction[axis] = bad;
      EXPECT_EQ(decide(ray, floor_at_1), no_hit);
      for (Vec3 Triangle::* corner : {&Triangle::a, &Triangle::b, &Triangle::c}) {
        Triangle triangle = floor_at_1;
        (triangle.*corner)[axis] = bad;
        EXPECT_EQ(decide(good, triangle), no_hit);
      }
    }
  }
  for (float Ray::* end : {&Ray::tnear, &Ray::tfar}) {
    Ray ray = good;
    ray.*end = std::nanf("");
    EXPECT_EQ(decide(ray, floor_at_1), no_hit);
  }
  EXPECT_EQ(decide({{0, 0, 1}, -1, {0, -0.0f, 0}}, floor_at_1), no_hit);
  EXPECT_EQ(decide({{0, 0, 1}, -1, {0, 1e-40f, 0}}, floor_at_1), no_hit);
  EXPECT_EQ(decide({{-4, 0, 1}, 0, {1, 0, 0}}, floor_at_1), no_hit) << "coplanar";
  EXPECT_EQ(decide(good, Triangle{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}), no_hit);
  EXPECT_EQ(decide(good, Triangle{{-1, 0, 1}, {0, 0, 1}, {5, 0, 1}}), no_hit);
}

TEST(DecideTriangle, DoesNotDependOnTheUnitOfLength) {
  Random random(7);
  for (int i = 0; i < 5000; ++i) {
    const auto style = i % 2 ? adversary::Style::natural : adversary::Style::small_integers;
    const Triangle triangle = adversary::triangle(random, style);
    const Ray ray = adversary::ray_towards(random, style, adversary::point_on(random, triangle));
    if (!adversary::bears_scaling(ray)) continue;
    const float t = decide(ray, triangle);
    for (const float scale : {0x1p-60f, 0x1p-3f, 0x1p60f}) {
      const Triangle scaled{scale * triangle.a, scale * triangle.b, scale * triangle.c};
      ASSERT_EQ(decide({scale * ray.origin, 0, scale * ray.direction}, scaled), t) << show(ray, triangle);
      if (t > 1e-10f && t < 1e10f) {
        ASSERT_EQ(decide({ray.origin, 0, scale * ray.direction}, triangle), t / scale) << show(ray, triangle);
      }
    }
  }
}

// From inside a closed mesh of 39,600 triangles no ray escapes through a vertex or an edge.
TEST(DecideTriangle, AClosedMeshIsWatertight) {
  const ClosedSphere sphere;
  const auto vertices = sphere.vertices();
  const auto triangles = sphere.triangles();
  ASSERT_EQ(triangles.size(), 39600u);

  // Only the triangles at the vertex or edge aimed at can be hit: the rest are thousands of ulps away.
  std::vector<std::vector<std::uint32_t>> at_vertex(vertices.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> at_edge;
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[i][k], to = triangles[i][(k + 1) % 3];
      at_vertex[from].push_back(i);
      at_edge[std::minmax(from, to)].push_back(i);
    }
  int misses = 0;
  const auto aim = [&](const Vec3& origin, const Vec3& target, const std::vector<std::uint32_t>& candidates) {
    const Ray ray{origin, 0, target - origin};
    misses += std::none_of(candidates.begin(), candidates.end(), [&](std::uint32_t i) {
      const auto& [a, b, c] = triangles[i];
      const Triangle triangle{vertices[a], vertices[b], vertices[c]};
      return may_hit(FilterRay(ray), triangle, no_hit) && decide(ray, triangle) != no_hit;
    });
  };
  for (const Vec3& origin : sphere.interior_points()) {
    for (std::size_t i = 0; i < vertices.size(); ++i) aim(origin, vertices[i], at_vertex[i]);
    for (const auto& [edge, candidates] : at_edge) {
      ASSERT_EQ(candidates.size(), 2u);
      aim(origin, sphere.middle_of(edge), candidates);
    }
  }
  EXPECT_EQ(misses, 0);
}

}  // namespace
}  // namespace raymeter
