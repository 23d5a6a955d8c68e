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
    const int rays = slow ? 1500 : 25000;
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

}  // namespace
}  // namespace raymeter
