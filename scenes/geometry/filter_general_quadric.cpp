#include <algorithm>
#include <cfloat>
#include <cmath>

#include "scenes/geometry/filter.h"

namespace raymeter {

// The line crosses the clip box from t = first to t = last, and there the polynomial is a quadratic with the
// Bernstein coefficients f(first), f(first, last) and f(last), where f(s, t) is its polar form. If the three
// are of one sign it has no root between; nor if the outer ones are of one sign and it has no root at all.
//
// Errors, with u = 2^-53: per coordinate W is the origin's distance from the centre and N the sum of W and of
// the farthest clip plane's. Both points lie in the box, so |t d| is below N (and a little, for the rounding
// of t, which is widened for). Each coordinate of a point relative to the centre is off by less than 5u N, a
// term q x y of the polynomial by 10u |q| N N and three roundings more, and the sum of ten by 10u more: less
// than 32u of M, the sum of the terms' magnitudes at (N, N, N); 2^-46 = 128u is used, for the rounding of M,
// too. The discriminant's factors are off by that much each, and it by three roundings. What underflows is of
// no account beside `tiny`.
bool may_hit(const FilterRay& filter_ray, const GeneralQuadric& quadric, float tmax) {
  const Ray& ray = filter_ray.ray;
  // A real t outside of this rounds to a float outside of the ray's interval, or to one beyond tmax.
  double first = double(ray.tnear) - std::abs(double(ray.tnear)) * 0x1p-22 - FLT_MIN,
         last = double(tmax) + std::abs(double(tmax)) * 0x1p-22 + FLT_MIN;
  Vec3d d, w, n;
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = flushed(ray.origin[axis]), centre = flushed(quadric.centre[axis]),
                 low = flushed(quadric.clip.low[axis]), high = flushed(quadric.clip.high[axis]);
    d[axis] = flushed(ray.direction[axis]), w[axis] = origin - centre;
    n[axis] = std::abs(w[axis]) + std::max(std::abs(low - centre), std::abs(high - centre));
    if (d[axis] == 0) {
      if (origin < low || origin > high) return false;
      continue;
    }
    const double inverse = 1 / d[axis], at_low = (low - origin) * inverse,
                 at_high = (high - origin) * inverse;
    first = std::max(first, std::min(at_low, at_high));
    last = std::min(last, std::max(at_low, at_high));
  }
  first -= std::abs(first) * 0x1p-50;
  last += std::abs(last) * 0x1p-50;
  if (!(first <= last)) return !(first > last);

  double q[10];
  for (std::size_t i = 0; i < 10; ++i) q[i] = flushed(quadric.coefficients[i]);
  const Vec3d from = w + first * d, to = w + last * d;
  // The polar form, with what the second point contributes given as half a gradient.
  const auto half_gradient = [&](const Vec3d& p) -> Vec3d {
    return {q[0] * p.x + 0.5 * (q[3] * p.y + q[5] * p.z + q[6]),
            q[1] * p.y + 0.5 * (q[3] * p.x + q[4] * p.z + q[7]),
            q[2] * p.z + 0.5 * (q[4] * p.y + q[5] * p.x + q[8])};
  };
  const Vec3d linear{q[6], q[7], q[8]}, at_from = half_gradient(from), at_to = half_gradient(to);
  const double at_first = dot(from, at_from) + (0.5 * dot(linear, from) + q[9]),
               between = dot(to, at_from) + (0.5 * dot(linear, from) + q[9]),
               at_last = dot(to, at_to) + (0.5 * dot(linear, to) + q[9]);
  for (double& x : q) x = std::abs(x);
  const double magnitude = (q[0] * n.x + q[3] * n.y + q[6]) * n.x + (q[1] * n.y + q[4] * n.z + q[7]) * n.y +
                           (q[2] * n.z + q[5] * n.x + q[8]) * n.z + q[9];
  constexpr double tiny = 64 * DBL_MIN;
  const double error = 0x1p-46 * magnitude + tiny;

  const double least = std::min(at_first, at_last), greatest = std::max(at_first, at_last);
  if (!(least > error || greatest < -error)) return true;
  if (least > error ? between > error : between < -error) return false;
  const double square = between * between, product = at_first * at_last;
  return !(square - product <
           -(error * (2 * std::abs(between) + std::abs(at_first) + std::abs(at_last) + 2 * error) +
             0x1p-50 * (square + product)));
}

}  // namespace raymeter
