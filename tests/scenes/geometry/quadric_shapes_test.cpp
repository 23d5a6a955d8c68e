#include "scenes/geometry/quadric_shapes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes/geometry/decide.h"

namespace raymeter {
namespace {

/// Turned by 3-4-5 triangles about two axes.
const Placement upright{{10, 20, 30}},
    tilted{{10, 20, 30}, {Vec3d{0.8, 0.36, 0.48}, Vec3d{-0.6, 0.48, 0.64}, Vec3d{0, -0.8, 0.6}}};

/// What the surface's formula says of the point, in the shape's own coordinates.
template <class Formula>
void expect_hits_satisfy(const GeneralQuadric& quadric, const Placement& placement, const Formula& formula) {
  int hits = 0;
  const Vec3d low = to_double(quadric.clip.low), size = to_double(quadric.clip.high) - low;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 1; i < 30; ++i)
      for (int j = 1; j < 30; ++j) {
        Vec3d origin = low, direction{};
        origin[(axis + 1) % 3] += size[(axis + 1) % 3] * i / 30;
        origin[(axis + 2) % 3] += size[(axis + 2) % 3] * j / 30;
        origin[axis] -= 1, direction[axis] = 1;
        const Ray ray{to_float(origin), 0, to_float(direction)};
        const float t = decide(ray, quadric);
        if (t == no_hit) continue;
        ++hits;
        const Vec3d p = to_double(ray.origin) + double(t) * direction - placement.centre;
        EXPECT_NEAR(formula(dot(p, placement.axes[0]), dot(p, placement.axes[1]), dot(p, placement.axes[2])),
                    0, 1e-4);
      }
  EXPECT_GT(hits, 100);
}

double square(double x) {
  return x * x;
}

TEST(QuadricShapes, AreWhatTheirFormulasSay) {
  for (const Placement& placement : {upright, tilted}) {
    expect_hits_satisfy(ellipsoid(placement, {1, 2, 3}), placement, [](double u, double v, double w) {
      return u * u + square(v / 2) + square(w / 3) - 1;
    });
    expect_hits_satisfy(elliptic_cylinder(placement, 1, 2, {-1, 2}), placement,
                        [](double u, double v, double) { return u * u + square(v / 2) - 1; });
    expect_hits_satisfy(elliptic_cone(placement, {1, 2, 3}, {-1, 2}), placement,
                        [](double u, double v, double w) { return u * u + square(v / 2) - square(w / 3); });
    expect_hits_satisfy(elliptic_paraboloid(placement, {1, 2, 3}, {0, 2}), placement,
                        [](double u, double v, double w) { return u * u + square(v / 2) - w / 3; });
    expect_hits_satisfy(
        hyperboloid_of_one_sheet(placement, {1, 2, 3}, {-1, 2}), placement,
        [](double u, double v, double w) { return u * u + square(v / 2) - square(w / 3) - 1; });
    expect_hits_satisfy(
        hyperboloid_of_two_sheets(placement, {1, 2, 3}, {3, 5}), placement,
        [](double u, double v, double w) { return u * u + square(v / 2) - square(w / 3) + 1; });
  }
}

TEST(QuadricShapes, EndWhereTheyAreToldTo) {
  for (const GeneralQuadric& q :
       {elliptic_cylinder(upright, 1, 2, {-1, 2}), elliptic_cone(upright, {1, 2, 3}, {-1, 2}),
        hyperboloid_of_one_sheet(upright, {1, 2, 3}, {-1, 2})}) {
    EXPECT_EQ(q.clip.low.z, 29.0f);
    EXPECT_EQ(q.clip.high.z, 32.0f);
    const Bounds box = bounds_of(q);
    EXPECT_EQ(box.low.z, 29.0f);
    EXPECT_EQ(box.high.z, 32.0f);
  }
}

TEST(QuadricShapes, AnEllipsoidsBoxIsThatOfItsRadii) {
  const Bounds box = bounds_of(ellipsoid(tilted, {1, 2, 3}));
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = length({tilted.axes[0][axis], 2 * tilted.axes[1][axis], 3 * tilted.axes[2][axis]});
    EXPECT_NEAR(box.low[axis], tilted.centre[axis] - reach, 1e-5);
    EXPECT_NEAR(box.high[axis], tilted.centre[axis] + reach, 1e-5);
  }
}

TEST(QuadricShapes, AxesAlongAreOrthonormal) {
  const auto axes = axes_along({1, 2, 2}, {0, 0, 5});
  EXPECT_NEAR(dot(axes[2], Vec3d{1, 2, 2}), 3, 1e-12);
  EXPECT_GT(axes[0].z, 0);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(dot(axes[i], axes[j]), i == j, 1e-12);
  EXPECT_GT(dot(cross(axes[0], axes[1]), axes[2]), 0);
}

}  // namespace
}  // namespace raymeter
