#include <gtest/gtest.h>

#include <cstring>

#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
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

}  // namespace
}  // namespace raymeter
