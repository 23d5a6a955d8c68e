#include "scenes/geometry/primitives.h"

#include <cmath>

#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// Extends the box by [low, high]. The few roundings on the way there are below 2^-49 of `magnitude`.
void extend_outward(Bounds& box, int axis, double low, double high, double magnitude) {
  const double margin = magnitude * 0x1p-48;
  box.low[axis] = std::min(box.low[axis], float_below(low - margin));
  box.high[axis] = std::max(box.high[axis], -float_below(-(high + margin)));
}

/// A disc of radius r about p, perpendicular to `axis` (of squared length l2), reaches r * sqrt(1 - a_i^2 /
/// l2) along coordinate i: (l2 - a_i^2) is summed from the other two so that nothing cancels. Without an axis
/// there is no surface; the box is that of a sphere then.
void extend_with_disc(Bounds& box, const Vec3& p, double r, const Vec3d& axis, double l2) {
  for (int i = 0; i < 3; ++i) {
    const double u = axis[(i + 1) % 3], v = axis[(i + 2) % 3];
    const double reach = l2 > 0 ? r * std::sqrt((u * u + v * v) / l2) : r;
    extend_outward(box, i, p[i] - reach, p[i] + reach, std::abs(double(p[i])) + reach);
  }
}

}  // namespace

Bounds bounds_of(const Quadric& quadric) {
  Bounds box;
  if (quadric.kind == QuadricKind::sphere) {
    const double r = quadric.base_radius;
    for (int i = 0; i < 3; ++i) {
      const double c = quadric.base[i];
      extend_outward(box, i, c - r, c + r, std::abs(c) + r);
    }
  } else {
    const Vec3d axis = to_double(quadric.apex) - to_double(quadric.base);
    const double l2 = dot(axis, axis);
    extend_with_disc(box, quadric.base, quadric.base_radius, axis, l2);
    extend_with_disc(box, quadric.apex, quadric.apex_radius, axis, l2);
  }
  return box;
}

}  // namespace raymeter
