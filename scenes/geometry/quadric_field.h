#pragma once
#include <array>

#include "scenes/geometry/primitives.h"

namespace raymeter {

/// The polynomial of a general quadric over a region of space, in double, for questions about boxes.
class QuadricField {
 public:
  /// A box relative to the quadric's centre.
  struct Box {
    Vec3d low, high;
  };

  /// Over the quadric's clip box. The quadric's numbers must be finite.
  explicit QuadricField(const GeneralQuadric& quadric);

  const Vec3d& centre() const { return centre_; }
  /// The region that it is about; as far as `shrink_to` has not made it smaller, the clip box.
  const Box& region() const { return region_; }
  /// Makes it about a part of its region, in which it can tell more.
  void shrink_to(const Box& part);

  /// The polynomial is certainly not zero in the part of `box` that lies within the region, nor in what
  /// 2^-49 of the region's reach (its farthest point's coordinates, from the centre) adds to it.
  ///
  /// About the middle m of a box with half sizes h, it is  p(m) + sum of (g_i e_i + q_i e_i^2) + sum of
  /// q_ij e_i e_j  for |e_i| <= h_i. Of the first sum, whose parts don't depend on each other, the exact
  /// range is taken, of each product the greatest magnitude: what that overestimates falls as the square of
  /// h. The rounding of m and of about 50 operations is below 2^-46 of the sum of the magnitudes of all terms
  /// at the reach of the region.
  bool certainly_misses(const Box& box) const;

  /// Not certain: for guesses only.
  double value(const Vec3d& p) const;

 private:
  Vec3d centre_;
  std::array<double, 10> q_;
  Box region_;
  double error_ = 0;
};

}  // namespace raymeter
