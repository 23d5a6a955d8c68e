#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <vector>

#include "scenes/geometry/primitives.h"
#include "scenes/geometry/quadric_shapes.h"
#include "tests/scenes/geometry/adversary.h"

namespace raymeter {
namespace {

using Real = boost::multiprecision::cpp_bin_float_100;
using Point = Vector3<Real>;

Real value_at(const GeneralQuadric& g, const Point& p) {
  const Point w{p.x - g.centre.x, p.y - g.centre.y, p.z - g.centre.z};
  const auto& q = g.coefficients;
  return q[0] * w.x * w.x + q[1] * w.y * w.y + q[2] * w.z * w.z + q[3] * w.x * w.y + q[4] * w.y * w.z +
         q[5] * w.z * w.x + q[6] * w.x + q[7] * w.y + q[8] * w.z + q[9];
}

/// Where the line along `axis` through p meets the surface within the clip box.
std::vector<Point> on_line(const GeneralQuadric& g, const Point& p, int axis) {
  Point next = p, before = p;
  next[axis] += 1, before[axis] -= 1;
  const Real here = value_at(g, p), up = value_at(g, next), down = value_at(g, before);
  const Real a = g.coefficients[static_cast<std::size_t>(axis)], b = (up - down) / 4,
             discriminant = b * b - a * here;
  std::vector<Real> steps;
  if (a == 0) {
    if (b != 0) steps.push_back(-here / (2 * b));
  } else if (discriminant >= 0) {
    const Real root = sqrt(discriminant);
    steps.push_back((-b - root) / a);
    steps.push_back((-b + root) / a);
  }
  std::vector<Point> points;
  for (const Real& step : steps) {
    Point point = p;
    point[axis] += step;
    if (point[axis] >= g.clip.low[axis] && point[axis] <= g.clip.high[axis]) points.push_back(point);
  }
  return points;
}

TEST(BoundsOfAGeneralQuadric, ContainItAndAreTight) {
  for (const auto style : {adversary::Style::natural, adversary::Style::halves, adversary::Style::far_away,
                           adversary::Style::small_integers}) {
    Random random(19, unsigned(style));
    int tight = 0, surfaces = 0;
    for (int n = 0; n < 40; ++n) {
      const GeneralQuadric g = adversary::general_quadric(random, style);
      const Bounds box = bounds_of(g);
      Bounds found;
      constexpr int lines = 20;
      for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i <= lines; ++i)
          for (int j = 0; j <= lines; ++j) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const Bounds& clip = g.clip;
            Point p;
            p[axis] = g.centre[axis];
            p[u] = clip.low[u] + (Real(clip.high[u]) - clip.low[u]) * i / lines;
            p[v] = clip.low[v] + (Real(clip.high[v]) - clip.low[v]) * j / lines;
            for (const Point& on : on_line(g, p, axis)) {
              for (int k = 0; k < 3; ++k) {
                ASSERT_GE(on[k], box.low[k]);
                ASSERT_LE(on[k], box.high[k]);
              }
              found.extend(Vec3{float(on.x), float(on.y), float(on.z)});
            }
          }
      if (found.empty()) continue;
      // The lines find the ends of most surfaces to a few hundredths.
      ++surfaces;
      tight += box.diagonal() <= found.diagonal() * 1.05;
    }
    EXPECT_GT(surfaces, 20);
    EXPECT_GT(tight, surfaces * 4 / 5) << surfaces << " style " << int(style);
  }
}

const std::array<Vec3d, 3> tilted{Vec3d{0.8, 0.36, 0.48}, Vec3d{-0.6, 0.48, 0.64}, Vec3d{0, -0.8, 0.6}};

void open_clip(GeneralQuadric& g, float reach) {
  for (int axis = 0; axis < 3; ++axis)
    g.clip.low[axis] = g.centre[axis] - reach, g.clip.high[axis] = g.centre[axis] + reach;
}

TEST(BoundsOfAGeneralQuadric, OfAnEllipsoidInAClipBoxOfAnySize) {
  for (const float reach : {4.0f, 5.0f, 1e3f, 1e9f, 1e30f}) {
    GeneralQuadric g = ellipsoid({{1, 2, 3}, tilted}, {1, 2, 3});
    open_clip(g, reach);
    const Bounds box = bounds_of(g);
    for (int axis = 0; axis < 3; ++axis) {
      const double half = length({tilted[0][axis], 2 * tilted[1][axis], 3 * tilted[2][axis]});
      EXPECT_LE(box.low[axis], g.centre[axis] - half + 1e-6);
      EXPECT_GE(box.high[axis], g.centre[axis] + half - 1e-6);
      EXPECT_GT(box.low[axis], g.centre[axis] - half * 1.003) << reach;
      EXPECT_LT(box.high[axis], g.centre[axis] + half * 1.003) << reach;
    }
  }
}

TEST(BoundsOfAGeneralQuadric, OfATiltedParaboloid) {
  // u^2 + (v/2)^2 = w/3 reaches down along n to -((n.u)^2 + (2 n.v)^2) / (12 n.w).
  GeneralQuadric g = elliptic_paraboloid({{0, 0, 0}, tilted}, {1, 2, 3}, {0, 1});
  open_clip(g, 2);
  const double n_u = tilted[0].z, n_v = 2 * tilted[1].z, n_w = tilted[2].z,
               lowest = -(n_u * n_u + n_v * n_v) / (12 * n_w);
  const Bounds box = bounds_of(g);
  EXPECT_LE(box.low.z, lowest + 1e-6);
  EXPECT_GE(box.low.z, lowest - 2e-3);
  EXPECT_EQ(box.high.z, 2);
}

TEST(BoundsOfAGeneralQuadric, OfAConesTip) {
  // A slender cone along (1, 0, 1), of which the box leaves one half: it begins at the tip.
  GeneralQuadric g = elliptic_cone({{0, 0, 0}, axes_along({1, 0, 1}, {0, 1, 0})}, {1, 1, 6}, {0, 1});
  open_clip(g, 1);
  g.clip.low.z = 0;
  const Bounds box = bounds_of(g);
  EXPECT_LE(box.low.x, 0);
  EXPECT_NEAR(box.low.x, 0, 1e-3);
  EXPECT_EQ(box.low.z, 0);
  EXPECT_EQ(box.high.x, 1);
}

TEST(BoundsOfAGeneralQuadric, OfNothingAreEmpty) {
  GeneralQuadric g = ellipsoid({{0, 0, 0}, tilted}, {1, 2, 3});
  g.clip = {{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}};
  EXPECT_TRUE(bounds_of(g).empty()) << "all inside";
  g.clip = {{2.9f, 2.9f, 2.9f}, {3, 3, 3}};
  EXPECT_TRUE(bounds_of(g).empty()) << "all outside";
  open_clip(g, 5);
  g.coefficients[9] = -g.coefficients[9];
  EXPECT_TRUE(bounds_of(g).empty()) << "no real point";
  g.coefficients[9] = NAN;
  EXPECT_TRUE(bounds_of(g).empty()) << "not a number";
}

}  // namespace
}  // namespace raymeter
