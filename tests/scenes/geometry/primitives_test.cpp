#include "scenes/geometry/primitives.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "tests/scenes/geometry/adversary.h"

namespace raymeter {
namespace {

using Real = boost::multiprecision::cpp_bin_float_100;

TEST(Bounds, OfAQuadricContainItAndAreTight) {
  Random random(9);
  for (const auto style : {adversary::Style::natural, adversary::Style::halves, adversary::Style::far_away}) {
    for (int n = 0; n < 3000; ++n) {
      const Quadric q = adversary::quadric(random, style);
      if (q.kind != QuadricKind::sphere && q.apex == q.base) continue;
      const Bounds box = bounds_of(q);
      for (int axis = 0; axis < 3; ++axis) {
        Real low = q.base[axis], high = low, size = abs(low);
        const auto extend = [&](const Vec3& centre, const Real& reach) {
          low = std::min<Real>(low, centre[axis] - reach), high = std::max<Real>(high, centre[axis] + reach);
          size = std::max<Real>(size, abs(Real(centre[axis])) + reach);
        };
        if (q.kind == QuadricKind::sphere) {
          extend(q.base, q.base_radius);
        } else {
          Vector3<Real> a;
          for (int i = 0; i < 3; ++i) a[i] = Real(q.apex[i]) - Real(q.base[i]);
          const Real share = sqrt(1 - a[axis] * a[axis] / (a.x * a.x + a.y * a.y + a.z * a.z));
          extend(q.base, q.base_radius * share);
          extend(q.apex, q.apex_radius * share);
        }
        ASSERT_LE(Real(box.low[axis]), low);
        ASSERT_GE(Real(box.high[axis]), high);
        ASSERT_LE(low - box.low[axis], size * 0x1p-23 + FLT_MIN);
        ASSERT_LE(box.high[axis] - high, size * 0x1p-23 + FLT_MIN);
      }
    }
  }
}

TEST(Bounds, OfAQuadricWithoutAxisAreFinite) {
  const Bounds box = bounds_of(Quadric{QuadricKind::cone, {1, 2, 3}, 1, {1, 2, 3}, 0});
  EXPECT_TRUE(is_finite(box.low) && is_finite(box.high) && !box.empty());
}

}  // namespace
}  // namespace raymeter
