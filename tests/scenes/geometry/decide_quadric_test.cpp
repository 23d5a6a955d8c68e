#include <gtest/gtest.h>

#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
#include "tests/scenes/geometry/adversary.h"
#include "tests/scenes/geometry/exact_reference.h"

namespace raymeter {
namespace {

std::string show(const Ray& ray, const Quadric& q) {
  std::string text = "kind " + std::to_string(int(q.kind));
  const auto add = [&](float x) {
    char number[40];
    std::snprintf(number, sizeof number, " %a", double(x));
    text += number;
  };
  for (const Vec3& v : {ray.origin, ray.direction, q.base, q.apex}) add(v.x), add(v.y), add(v.z);
  for (const float x : {q.base_radius, q.apex_radius, ray.tnear, ray.tfar}) add(x);
  return text;
}

TEST(DecideQuadric, IsTheExactAnswerRounded) {
  for (const auto style : adversary::styles) {
    Random random(4, unsigned(style));
    // Numbers of 300 bits make the reference slow.
    const bool slow = style == adversary::Style::mixed_scales || style == adversary::Style::extremes;
    int hits = 0;
    const int rays = slow ? 1500 : 24500;
    for (int i = 0; i < rays; ++i) {
      const Quadric quadric = adversary::quadric(random, style);
      Ray ray = adversary::ray_towards(random, style, quadric);
      if (random.below(2) == 0) ray.tnear = -no_hit;
      adversary::tempt_interval(random, ray, decide(ray, quadric));
      const float truth = reference::decide(ray, quadric);
      hits += truth != no_hit;
      ASSERT_EQ(decide(ray, quadric), truth) << show(ray, quadric);
      const FlushDenormals mode;
      ASSERT_EQ(decide(ray, quadric), truth) << show(ray, quadric);
    }
    EXPECT_GT(hits, slow ? rays / 50 : rays / 10) << int(style);
  }
}

const float above_1 = std::nextafter(1.0f, 2.0f);
Quadric sphere(const Vec3& centre, float radius) {
  return {QuadricKind::sphere, centre, radius, {}, 0};
}

const Quadric unit_sphere = sphere({0, 0, 0}, 1);
const Quadric pipe{QuadricKind::cylinder, {0, 0, 0}, 1, {0, 0, 1}, 1};
const Quadric hat{QuadricKind::cone, {0, 0, 0}, 1, {0, 0, 1}, 0};

TEST(DecideQuadric, SphereByHand) {
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, unit_sphere), 2.0f);
  EXPECT_EQ(decide({{-3, 0, 0}, 2, {1, 0, 0}}, unit_sphere), 4.0f);
  EXPECT_EQ(decide({{-3, 0, 0}, 4, {1, 0, 0}}, unit_sphere), no_hit);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}, 1.5f}, unit_sphere), no_hit);
  EXPECT_EQ(decide({{-3, 1, 0}, 0, {1, 0, 0}}, unit_sphere), 3.0f) << "touching";
  EXPECT_EQ(decide({{-3, above_1, 0}, 0, {1, 0, 0}}, unit_sphere), no_hit);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, sphere({1, 0, 0}, 0)), 4.0f) << "a point";
}

TEST(DecideQuadric, CylinderByHand) {
  EXPECT_EQ(decide({{-3, 0, 0.5f}, 0, {1, 0, 0}}, pipe), 2.0f);
  EXPECT_EQ(decide({{-3, 0, 1}, 0, {1, 0, 0}}, pipe), 2.0f) << "the rim belongs to it";
  EXPECT_EQ(decide({{-3, 0, above_1}, 0, {1, 0, 0}}, pipe), no_hit);
  EXPECT_EQ(decide({{-3, 0, -0x1p-120f}, 0, {1, 0, 0}}, pipe), no_hit);
  EXPECT_EQ(decide({{-3, 1, 0.5f}, 0, {1, 0, -0.0f}}, pipe), 3.0f) << "touching";
  EXPECT_EQ(decide({{-3, above_1, 0.5f}, 0, {1, 0, 0}}, pipe), no_hit);
  EXPECT_EQ(decide({{0, 0, -1}, 0, {0, 0, 1}}, pipe), no_hit) << "along the axis";
  EXPECT_EQ(decide({{1, 0, -1}, 0, {0, 0, 1}}, pipe), no_hit) << "in the surface";
  EXPECT_EQ(decide({{-3, 0, -1}, 0, {1, 0, 0.5f}}, pipe), 2.0f) << "the lower rim";
  EXPECT_EQ(decide({{-2, 0, -1}, 0, {1, 0, 0.5f}}, pipe), 3.0f) << "past the lower rim";
}

TEST(DecideQuadric, ConeByHand) {
  EXPECT_EQ(decide({{-3, 0, 0.5f}, 0, {1, 0, 0}}, hat), 2.5f);
  EXPECT_EQ(decide({{-3, 0, 1}, 0, {1, 0, 0}}, hat), 3.0f) << "the tip";
  EXPECT_EQ(decide({{-3, 0, 1.5f}, 0, {1, 0, 0}}, hat), no_hit) << "the mirrored half does not exist";
  EXPECT_EQ(decide({{0, 0, 3}, 0, {0, 0, -1}}, hat), 2.0f) << "the tip, from above";
  EXPECT_EQ(decide({{0, 0, 0}, 0, {1, 0, -1}}, hat), no_hit);
  EXPECT_EQ(decide({{0.5f, 0, 0}, 0, {-1, 0, 1}, 9}, hat), 0.75f) << "parallel to a generator";
  EXPECT_EQ(decide({{0, 0, 0}, 0, {-1, 0, -1}, 9}, hat), no_hit);
  EXPECT_EQ(decide({{0.5f, 0, 0}, 0, {1, 0, 1}, 9}, hat), 0.25f) << "parallel to the opposite one";
  EXPECT_EQ(decide({{1, 0, 0}, -1, {-1, 0, 1}}, hat), no_hit) << "in the surface";
}

TEST(DecideQuadric, WhatIsNoRayAndWhatIsNoQuadricMisses) {
  for (const float bad : {no_hit, -no_hit, std::nanf("")}) {
    EXPECT_EQ(decide({{bad, 0, 0}, 0, {1, 0, 0}}, unit_sphere), no_hit);
    EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, bad, 0}}, unit_sphere), no_hit);
    EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, sphere({0, 0, 0}, bad)), no_hit);
    EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, Quadric{QuadricKind::cone, {0, 0, 0}, 1, {0, bad, 0}, 1}),
              no_hit);
  }
  EXPECT_EQ(decide({{-3, 0, 0}, -9, {0, -0.0f, 1e-40f}}, unit_sphere), no_hit);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, Quadric{QuadricKind::cylinder, {0, 0, 0}, 1, {0, 0, 0}, 1}),
            no_hit);
}

TEST(DecideQuadric, DoesNotDependOnTheUnitOfLength) {
  Random random(8);
  for (int i = 0; i < 3000; ++i) {
    const auto style = i % 2 ? adversary::Style::halves : adversary::Style::small_integers;
    const Quadric q = adversary::quadric(random, style);
    const Ray ray = adversary::ray_towards(random, style, Vec3{0, 0, 0});
    if (!adversary::bears_scaling(ray)) continue;
    const float t = decide(ray, q);
    for (const float scale : {0x1p-60f, 0x1p-3f, 0x1p60f}) {
      const Quadric scaled{q.kind, scale * q.base, scale * q.base_radius, scale * q.apex,
                           scale * q.apex_radius};
      ASSERT_EQ(decide({scale * ray.origin, 0, scale * ray.direction}, scaled), t) << show(ray, q);
    }
  }
}

}  // namespace
}  // namespace raymeter
