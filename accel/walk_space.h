#pragma once
// What every walk of a ray through a subdivided box has in common, and why no walk here loses a hit.
//
// All walks compute in double, from planes whose positions are functions of integer cell indices (never
// accumulated). A plane's crossing (plane - o) / d is then wrong by a few roundings of the distances in it,
// so at every t each coordinate of the ray's point is within 2^-51 * (distance from the ray's origin + extent
// of the box) of the cell that the walk believes to be in at that t. `margin` is larger than that for every
// ray that starts within 2^16 diagonals of the box. So it suffices that a primitive is registered in every
// cell whose box, grown by `margin` on all sides, meets the primitive: then the cell the walk is in at the
// hit's real t lists the primitive. Rays from farther away are `too_far` and must be answered without a walk,
// by testing every primitive.
//
// The t of a hit is that real t rounded to float (decide.h). What a walk may skip is decided by the float, so
// every comparison of a walk's t with a float one leaves room for the rounding: see `latest`.
#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/geometry/bounds.h"
#include "scenes/geometry/ray.h"

namespace raymeter {

/// The box that a structure subdivides: the scene's, grown by the margin, so that it is nowhere flat.
struct WalkSpace {
  Vec3d low, high;
  double margin = 0;
  double far_limit = 0;  ///< rays that start farther than this from the box (1-norm) are `too_far`

  WalkSpace() = default;
  /// `box` must not be empty. A walk that is less exact than those in double needs a margin of `of_diagonal`
  /// of its diagonal, or of `of_magnitude` of its greatest coordinate.
  explicit WalkSpace(const Bounds& box, double of_diagonal = 0x1p-32, double of_magnitude = 0x1p-45) {
    const double diagonal = box.diagonal();
    double magnitude = 0x1p-126;
    for (int axis = 0; axis < 3; ++axis)
      magnitude = std::max({magnitude, std::abs(double(box.low[axis])), std::abs(double(box.high[axis]))});
    // The second term keeps the margin well above the rounding of a coordinate, in a small box far from 0.
    margin = std::max(diagonal * of_diagonal, magnitude * of_magnitude);
    far_limit = diagonal * 0x1p16;
    low = to_double(box.low) - Vec3d{margin, margin, margin};
    high = to_double(box.high) + Vec3d{margin, margin, margin};
  }
  Vec3d extent() const { return high - low; }
};

/// A traceable ray (ray.h) in double. Directions of 0 and -0 have an inverse of +-inf, which callers must not
/// multiply by 0: see `crossing`.
struct WalkRay {
  Vec3d origin, direction, inverse;

  explicit WalkRay(const Ray& ray)
      : origin(to_double(ray.origin)),
        direction(to_double(ray.direction)),
        inverse{1 / direction.x, 1 / direction.y, 1 / direction.z} {}

  /// The t at which the ray crosses the plane at `position` on `axis`; +inf when it never does.
  double crossing(int axis, double position) const {
    return direction[axis] == 0 ? std::numeric_limits<double>::infinity()
                                : (position - origin[axis]) * inverse[axis];
  }
};

struct WalkInterval {
  double enter, leave;
  bool empty() const { return !(enter <= leave); }
};

/// No hit whose float t is `t` or less lies, as a real number, beyond this: room for its rounding (2^-24
/// relative) and, near 0, for flushing it.
inline double latest(float t) {
  return double(t) + std::abs(double(t)) * 0x1p-22 + double(std::numeric_limits<float>::min());
}

/// The part of the ray inside the box low..high where hits in its interval may lie. The box must have been
/// grown by a margin: the rounding here is below that. Empty where the ray misses.
inline WalkInterval clip(const WalkRay& walk, const Ray& ray, const Vec3d& low, const Vec3d& high) {
  WalkInterval interval{double(ray.tnear) - double(std::numeric_limits<float>::min()), latest(ray.tfar)};
  for (int axis = 0; axis < 3; ++axis) {
    // Along an axis on which the ray does not move these are infinite, of one sign where it passes outside;
    // or NaN where it runs along a plane of the box, which is a margin away from everything.
    const double t0 = (low[axis] - walk.origin[axis]) * walk.inverse[axis];
    const double t1 = (high[axis] - walk.origin[axis]) * walk.inverse[axis];
    interval.enter = std::max(interval.enter, std::min(t0, t1));
    interval.leave = std::min(interval.leave, std::max(t0, t1));
  }
  return interval;
}

/// Whether the ray starts too far from the box for a walk in double to be proved (see above).
inline bool too_far(const WalkRay& walk, const WalkSpace& space) {
  double distance = 0;
  for (int axis = 0; axis < 3; ++axis)
    distance += std::max({0.0, space.low[axis] - walk.origin[axis], walk.origin[axis] - space.high[axis]});
  return distance > space.far_limit;
}

}  // namespace raymeter
