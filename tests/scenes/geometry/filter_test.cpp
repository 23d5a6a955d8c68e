#include "scenes/geometry/filter.h"

#include <gtest/gtest.h>

#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
#include "tests/scenes/geometry/adversary.h"

namespace raymeter {
namespace {

/// A value of tmax that a traversal could pass, often the hit's own t or its neighbours.
float tempting_tmax(Random& random, float t) {
  if (t == no_hit) return random.below(2) ? no_hit : random.uniform(-1, 3);
  switch (random.below(5)) {
    case 0:
      return t;
    case 1:
      return std::nextafter(t, -FLT_MAX);
    case 2:
      return std::nextafter(t, FLT_MAX);
    case 3:
      return random.uniform(-1, 3);
    default:
      return no_hit;
  }
}

/// Counts what a filter makes of it: it must not reject what decide accepts.
struct Tally {
  int rejected = 0;  ///< misses that the filter spared decide
  int passed = 0;    ///< misses that it did not
  int beyond = 0;    ///< hits beyond tmax that it rejected

  template <class Primitive>
  testing::AssertionResult add(const Ray& ray, const Primitive& primitive, float tmax) {
    const float t = decide(ray, primitive);
    const bool may = may_hit(FilterRay(ray), primitive, tmax);
    if (t != no_hit && t <= tmax && !may)
      return testing::AssertionFailure() << "rejects the hit at " << t << ", tmax " << tmax;
    (t == no_hit ? (may ? passed : rejected) : beyond) += 1;
    return testing::AssertionSuccess();
  }
};

TEST(FilterTriangle, RejectsNothingThatDecideAccepts) {
  Random random(2);
  for (const auto style : adversary::styles) {
    Tally tally;
    for (int i = 0; i < 40000; ++i) {
      const Triangle triangle = adversary::triangle(random, style);
      Ray ray = adversary::ray_towards(random, style, adversary::point_on(random, triangle));
      if (random.below(4) == 0) ray.tnear = -no_hit;
      const float t = decide(ray, triangle);
      adversary::tempt_interval(random, ray, t);
      const float tmax = tempting_tmax(random, t);
      ASSERT_TRUE(tally.add(ray, triangle, tmax));
      const FlushDenormals mode;
      ASSERT_TRUE(tally.add(ray, triangle, tmax));
    }
  }
}

TEST(FilterQuadric, RejectsNothingThatDecideAccepts) {
  for (const auto style : adversary::styles) {
    Random random(5, unsigned(style));
    const bool slow = style == adversary::Style::mixed_scales || style == adversary::Style::extremes;
    Tally tally;
    for (int i = 0; i < (slow ? 5000 : 30000); ++i) {
      const Quadric quadric = adversary::quadric(random, style);
      Ray ray = adversary::ray_towards(random, style, quadric);
      if (random.below(4) == 0) ray.tnear = -no_hit;
      const float t = decide(ray, quadric);
      adversary::tempt_interval(random, ray, t);
      const float tmax = tempting_tmax(random, t);
      ASSERT_TRUE(tally.add(ray, quadric, tmax));
      const FlushDenormals mode;
      ASSERT_TRUE(tally.add(ray, quadric, tmax));
    }
  }
}

TEST(FilterGeneralQuadric, RejectsNothingThatDecideAccepts) {
  for (const auto style : adversary::styles) {
    Random random(15, unsigned(style));
    const bool slow = style == adversary::Style::mixed_scales || style == adversary::Style::extremes;
    Tally tally;
    for (int i = 0; i < (slow ? 5000 : 30000); ++i) {
      const GeneralQuadric quadric = adversary::general_quadric(random, style);
      Ray ray = adversary::ray_towards(random, style, quadric);
      if (random.below(4) == 0) ray.tnear = -no_hit;
      const float t = decide(ray, quadric);
      adversary::tempt_interval(random, ray, t);
      const float tmax = tempting_tmax(random, t);
      ASSERT_TRUE(tally.add(ray, quadric, tmax));
      const FlushDenormals mode;
      ASSERT_TRUE(tally.add(ray, quadric, tmax));
    }
  }
}

TEST(FilterTriangle, SparesDecideTheOrdinaryMisses) {
  Random random(3);
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    const Triangle triangle = adversary::triangle(random, adversary::Style::natural);
    const Vec3 origin = adversary::point(random, adversary::Style::natural);
    const Vec3 direction = adversary::point(random, adversary::Style::natural);
    ASSERT_TRUE(tally.add(Ray{origin, 0, direction, 0.5f}, triangle, 0.5f));
  }
  EXPECT_GT(tally.rejected, 1000 * tally.passed);
}

TEST(FilterQuadric, SparesDecideTheOrdinaryMisses) {
  Random random(6);
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    const Quadric quadric = adversary::quadric(random, adversary::Style::natural);
    const Vec3 origin = adversary::point(random, adversary::Style::natural);
    const Vec3 direction = adversary::point(random, adversary::Style::natural);
    ASSERT_TRUE(tally.add(Ray{origin, 0, direction, 0.5f}, quadric, 0.5f));
  }
  EXPECT_GT(tally.rejected, tally.passed) << tally.passed;
}

TEST(FilterGeneralQuadric, SparesDecideAlmostAllMisses) {
  Random random(16);
  Tally tally;
  for (int i = 0; i < 20000; ++i) {
    const GeneralQuadric quadric = adversary::general_quadric(random, adversary::Style::natural);
    const Vec3 origin = adversary::point(random, adversary::Style::natural);
    const Vec3 direction = adversary::point(random, adversary::Style::natural);
    ASSERT_TRUE(tally.add(Ray{origin, 0, direction, 0.5f}, quadric, 0.5f));
  }
  EXPECT_GT(tally.rejected, 1000 * tally.passed) << tally.passed;
}

}  // namespace
}  // namespace raymeter
