#include "scenes/geometry/quadric_field.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

Vec3d flushed_to_double(const Vec3& v) {
  return {flushed(v.x), flushed(v.y), flushed(v.z)};
}

struct Range {
  double low, high;
};

/// Of g e + q e^2 for |e| <= h.
Range range_of(double g, double q, double h) {
  const double slope = std::abs(g) * h, bend = q * h * h;
  Range range{bend - slope, bend + slope};
  // Where the parabola's vertex lies inside, it is -g^2 / 4q there.
  if (std::abs(g) < 2 * std::abs(q) * h) {
    const double vertex = -g * g / (4 * q);
    range = q > 0 ? Range{vertex, bend + slope} : Range{bend - slope, vertex};
  }
  return range;
}

}  // namespace

QuadricField::QuadricField(const GeneralQuadric& quadric) : centre_(flushed_to_double(quadric.centre)) {
  for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = flushed(quadric.coefficients[i]);
  shrink_to({flushed_to_double(quadric.clip.low) - centre_, flushed_to_double(quadric.clip.high) - centre_});
}

void QuadricField::shrink_to(const Box& part) {
  region_ = part;
  Vec3d r;
  for (int i = 0; i < 3; ++i) r[i] = std::max(std::abs(part.low[i]), std::abs(part.high[i]));
  double magnitude = std::abs(q_[9]);
  const double terms[] = {r.x * r.x, r.y * r.y, r.z * r.z, r.x * r.y, r.y * r.z, r.z * r.x, r.x, r.y, r.z};
  for (std::size_t i = 0; i < 9; ++i) magnitude += std::abs(q_[i]) * terms[i];
  error_ = magnitude * 0x1p-46 + DBL_MIN * 64;
}

bool QuadricField::certainly_misses(const Box& box) const {
  Vec3d m, h;
  for (int i = 0; i < 3; ++i) {
    const double low = std::max(box.low[i], region_.low[i]), high = std::min(box.high[i], region_.high[i]);
    m[i] = 0.5 * (low + high), h[i] = std::max(0.0, 0.5 * (high - low));
  }
  const auto& [xx, yy, zz, xy, yz, zx, x, y, z, one] = q_;
  const Vec3d linear{x, y, z};
  const Vec3d half_gradient{xx * m.x + 0.5 * (xy * m.y + zx * m.z), yy * m.y + 0.5 * (xy * m.x + yz * m.z),
                            zz * m.z + 0.5 * (zx * m.x + yz * m.y)};
  const double middle = dot(m, half_gradient + linear) + one;
  const Vec3d gradient = half_gradient + half_gradient + linear;
  const double mixed =
      std::abs(xy) * h.x * h.y + std::abs(yz) * h.y * h.z + std::abs(zx) * h.z * h.x + error_;
  const Range along[] = {range_of(gradient.x, xx, h.x), range_of(gradient.y, yy, h.y),
                         range_of(gradient.z, zz, h.z)};
  return middle + along[0].low + along[1].low + along[2].low > mixed ||
         middle + along[0].high + along[1].high + along[2].high < -mixed;
}

double QuadricField::value(const Vec3d& p) const {
  const auto& [xx, yy, zz, xy, yz, zx, x, y, z, one] = q_;
  return (xx * p.x + xy * p.y + x) * p.x + (yy * p.y + yz * p.z + y) * p.y + (zz * p.z + zx * p.x + z) * p.z +
         one;
}

}  // namespace raymeter
