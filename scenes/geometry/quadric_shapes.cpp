#include "scenes/geometry/quadric_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// (u/a)^2 + (v/b)^2 = square (w/c)^2 + linear (w/c) + constant, the square of the width at w.
struct Profile {
  double square, linear, constant;
};

/// Room in the box for the rounding of the coefficients.
constexpr double room = 1 + 0x1p-20;

void extend(Bounds& box, int axis, double middle, double reach) {
  box.low[axis] = std::min(box.low[axis], float_below(middle - reach * room));
  box.high[axis] = std::max(box.high[axis], -float_below(-(middle + reach * room)));
}

/// The whole surface, without a clip box.
GeneralQuadric unclipped(const Placement& placement, const Vec3d& radii, const Profile& profile) {
  // Multiplied by the least radius squared, so that no coefficient but the last is much above 1.
  const double least = std::min({std::abs(radii.x), std::abs(radii.y), std::abs(radii.z)}),
               unit = least * least;
  const Vec3d squares{unit / (radii.x * radii.x), unit / (radii.y * radii.y),
                      -profile.square * unit / (radii.z * radii.z)};
  GeneralQuadric quadric;
  quadric.centre = to_float(placement.centre);
  auto& q = quadric.coefficients;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    double square = 0, mixed = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3d& axis = placement.axes[static_cast<std::size_t>(k)];
      square += squares[k] * axis[i] * axis[i];
      mixed += 2 * squares[k] * axis[i] * axis[j];
    }
    const auto at = static_cast<std::size_t>(i);
    q[at] = static_cast<float>(square);
    q[3 + at] = static_cast<float>(mixed);
    q[6 + at] = static_cast<float>(-profile.linear * unit / radii.z * placement.axes[2][i]);
  }
  q[9] = static_cast<float>(-profile.constant * unit);
  return quadric;
}

/// Clipped by the box of the ellipses at the two ends, which holds all between where that does not bulge;
/// where it does, the box is that of the wider ellipse at both ends.
GeneralQuadric clipped(const Placement& placement, const Vec3d& radii, const Profile& profile,
                       const Stretch& stretch) {
  GeneralQuadric quadric = unclipped(placement, radii, profile);
  const auto width_at = [&](double w) {
    const double x = w / radii.z;
    return std::sqrt(std::max(0.0, (profile.square * x + profile.linear) * x + profile.constant));
  };
  double from = width_at(stretch.from), to = width_at(stretch.to);
  const bool bulges = profile.linear != 0 || profile.constant < 0;
  if (bulges) from = to = std::max(from, to);
  const auto& [u, v, w] = placement.axes;
  for (int axis = 0; axis < 3; ++axis) {
    const double across = length({radii.x * u[axis], radii.y * v[axis], 0});
    extend(quadric.clip, axis, quadric.centre[axis] + stretch.from * w[axis], from * across);
    extend(quadric.clip, axis, quadric.centre[axis] + stretch.to * w[axis], to * across);
  }
  return quadric;
}

}  // namespace

std::array<Vec3d, 3> axes_along(const Vec3d& direction, const Vec3d& across) {
  const Vec3d w = normalized(direction), u = normalized(across - dot(across, w) * w);
  return {u, cross(w, u), w};
}

GeneralQuadric ellipsoid(const Placement& placement, const Vec3d& radii) {
  GeneralQuadric quadric = unclipped(placement, radii, {-1, 0, 1});
  const auto& [u, v, w] = placement.axes;
  for (int axis = 0; axis < 3; ++axis)
    extend(quadric.clip, axis, quadric.centre[axis],
           length({radii.x * u[axis], radii.y * v[axis], radii.z * w[axis]}));
  return quadric;
}

GeneralQuadric elliptic_cylinder(const Placement& placement, double a, double b, const Stretch& stretch) {
  return clipped(placement, {a, b, std::min(a, b)}, {0, 0, 1}, stretch);
}

GeneralQuadric elliptic_cone(const Placement& placement, const Vec3d& radii, const Stretch& stretch) {
  return clipped(placement, radii, {1, 0, 0}, stretch);
}

GeneralQuadric elliptic_paraboloid(const Placement& placement, const Vec3d& radii, const Stretch& stretch) {
  return clipped(placement, radii, {0, 1, 0}, stretch);
}

GeneralQuadric hyperboloid_of_one_sheet(const Placement& placement, const Vec3d& radii,
                                        const Stretch& stretch) {
  return clipped(placement, radii, {1, 0, 1}, stretch);
}

GeneralQuadric hyperboloid_of_two_sheets(const Placement& placement, const Vec3d& radii,
                                         const Stretch& stretch) {
  return clipped(placement, radii, {1, 0, -1}, stretch);
}

}  // namespace raymeter
