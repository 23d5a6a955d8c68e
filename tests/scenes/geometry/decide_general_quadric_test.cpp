#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
#include "tests/scenes/geometry/adversary.h"
#include "tests/scenes/geometry/exact_reference.h"

namespace raymeter {
namespace {

std::string show(const Ray& ray, const GeneralQuadric& q) {
  std::string text;
  const auto add = [&](float x) {
    char number[40];
    std::snprintf(number, sizeof number, " %a", double(x));
    text += number;
  };
  for (const Vec3& v : {ray.origin, ray.direction, q.centre, q.clip.low, q.clip.high})
    add(v.x), add(v.y), add(v.z);
  for (const float x : q.coefficients) add(x);
  add(ray.tnear), add(ray.tfar);
  return text;
}

TEST(DecideGeneralQuadric, IsTheExactAnswerRounded) {
  for (const auto style : adversary::styles) {
    Random random(14, unsigned(style));
    // Numbers of 600 bits make the reference slow.
    const bool slow = style == adversary::Style::mixed_scales || style == adversary::Style::extremes;
    int hits = 0;
    const int rays = slow ? 2500 : 24500;
    for (int i = 0; i < rays; ++i) {
      const GeneralQuadric quadric = adversary::general_quadric(random, style);
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
const Bounds around{{-2, -2, -2}, {2, 2, 2}};

//                                    x2 y2 z2 xy yz zx x  y  z  1
const GeneralQuadric ball{{0, 0, 0}, {1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, around};
const GeneralQuadric half_ball{{0, 0, 0}, {1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, {{-2, -2, 0}, {2, 2, 2}}};
const GeneralQuadric bowl{{0, 0, 0}, {1, 1, 0, 0, 0, 0, 0, 0, -1, 0}, around};
const GeneralQuadric waist{{0, 0, 0}, {1, 1, -1, 0, 0, 0, 0, 0, 0, -1}, around};
const GeneralQuadric double_cone{{0, 0, 0}, {1, 1, -1, 0, 0, 0, 0, 0, 0, 0}, around};
const GeneralQuadric plane{{0, 0, 0}, {0, 0, 0, 0, 0, 0, 1, 1, 0, -1}, around};
const GeneralQuadric double_plane{{0, 0, 0}, {1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, around};

TEST(DecideGeneralQuadric, EllipsoidByHand) {
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, ball), 2.0f);
  EXPECT_EQ(decide({{-3, 0, 0}, 2, {1, 0, 0}}, ball), 4.0f);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}, 1.5f}, ball), no_hit);
  EXPECT_EQ(decide({{-3, 1, 0}, 0, {1, 0, 0}}, ball), 3.0f) << "touching";
  EXPECT_EQ(decide({{-3, above_1, 0}, 0, {1, 0, 0}}, ball), no_hit);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, half_ball), 2.0f) << "the cut belongs to it";
  EXPECT_EQ(decide({{-3, 0, -0x1p-120f}, 0, {1, 0, 0}}, half_ball), no_hit);
  EXPECT_EQ(decide({{0, 0, -3}, 0, {0, 0, 1}}, half_ball), 4.0f) << "the far side, through the cut";
}

TEST(DecideGeneralQuadric, ParaboloidByHand) {
  EXPECT_EQ(decide({{0, 0, 3}, 0, {0, 0, -1}}, bowl), 3.0f) << "parallel to the axis";
  EXPECT_EQ(decide({{1, 0, 3}, 0, {0, 0, -1}}, bowl), 2.0f);
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, bowl), 3.0f) << "touching";
  EXPECT_EQ(decide({{-3, 0, 4}, 0, {1, 0, 0}}, bowl), no_hit) << "above the box";
  EXPECT_EQ(decide({{-3, 0, 1}, 0, {1, 0, 0}}, bowl), 2.0f);
}

TEST(DecideGeneralQuadric, HyperboloidAndConeByHand) {
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, waist), 2.0f);
  EXPECT_EQ(decide({{0, 0, -3}, 0, {0, 0, 1}}, waist), no_hit) << "along the axis";
  EXPECT_EQ(decide({{1, 0, 0}, -9, {0, 1, 1}}, waist), no_hit) << "a line of the surface";
  EXPECT_EQ(decide({{2, 0, 0}, -9, {0, 1, 1}}, waist), no_hit) << "parallel to it";
  EXPECT_EQ(decide({{0, 0, 0}, -9, {0, 1, 1}}, waist), no_hit) << "an asymptote";
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, double_cone), 3.0f) << "the tip";
  EXPECT_EQ(decide({{0, 0, -3}, 0, {0, 0, 1}}, double_cone), 3.0f) << "the tip, along the axis";
  EXPECT_EQ(decide({{-3, 0, 1}, 0, {1, 0, 0}}, double_cone), 2.0f);
  EXPECT_EQ(decide({{0, -1, -1}, 0, {0, 1, 1}}, double_cone), no_hit) << "in the surface";
  EXPECT_EQ(decide({{0, 1, 0}, 0, {0, 1, 1}}, double_cone), no_hit) << "parallel to it, moving away";
  EXPECT_EQ(decide({{0, 1, 0}, -9, {0, 1, 1}}, double_cone), -0.5f);
}

TEST(DecideGeneralQuadric, PlanesByHand) {
  EXPECT_EQ(decide({{-3, 0, 0}, 0, {1, 0, 0}}, plane), 4.0f);
  EXPECT_EQ(decide({{-3, -1, 0}, 0, {1, 0, 0}}, plane), 5.0f) << "a corner of the box";
  EXPECT_EQ(decide({{-3, -1.5f, 0}, 0, {1, 0, 0}}, plane), no_hit);
  EXPECT_EQ(decide({{1, 0, 0}, -9, {1, -1, 0}}, plane), no_hit) << "in it";
  EXPECT_EQ(decide({{-3, -1, 0}, 0, {1, 0, 0}}, double_plane), 3.0f);
  EXPECT_EQ(decide({{0, -1, 0}, 0, {0, 1, 0}}, double_plane), no_hit) << "in it";
}

TEST(DecideGeneralQuadric, WhatIsNoRayAndWhatIsNoQuadricMisses) {
  const Ray ray{{-3, 0, 0}, 0, {1, 0, 0}};
  for (const float bad : {no_hit, -no_hit, std::nanf("")}) {
    EXPECT_EQ(decide({{bad, 0, 0}, 0, {1, 0, 0}}, ball), no_hit);
    GeneralQuadric broken = ball;
    broken.centre.y = bad;
    EXPECT_EQ(decide(ray, broken), no_hit);
    broken = ball, broken.coefficients[4] = bad;
    EXPECT_EQ(decide(ray, broken), no_hit);
    broken = ball, broken.clip.high.z = bad;
    EXPECT_EQ(decide(ray, broken), no_hit);
  }
  EXPECT_EQ(decide(ray, GeneralQuadric{{0, 0, 0}, {}, around}), no_hit) << "zero everywhere";
  EXPECT_EQ(decide(ray, GeneralQuadric{{0, 0, 0}, {1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, {}}), no_hit) << "no box";
}

}  // namespace
}  // namespace raymeter
