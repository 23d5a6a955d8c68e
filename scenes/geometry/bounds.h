#pragma once
#include <algorithm>
#include <limits>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// An axis-aligned box, closed. The default is empty (low above high).
struct Bounds {
  Vec3 low{inf, inf, inf};
  Vec3 high{-inf, -inf, -inf};

  void extend(const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  void extend(const Bounds& box) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], box.low[axis]);
      high[axis] = std::max(high[axis], box.high[axis]);
    }
  }
  bool empty() const { return low.x > high.x; }
  /// high - low in double, where the difference of two floats can't overflow; {0,0,0} when empty.
  Vec3d extent() const { return empty() ? Vec3d{} : to_double(high) - to_double(low); }
  double diagonal() const { return length(extent()); }

 private:
  static constexpr float inf = std::numeric_limits<float>::infinity();
};

}  // namespace raymeter
