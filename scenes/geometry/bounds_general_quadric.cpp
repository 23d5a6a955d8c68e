#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "scenes/geometry/primitives.h"
#include "scenes/geometry/quadric_field.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

using Box = QuadricField::Box;

/// Looks for the end of the surface along one axis: branch and bound, best first (the interval method of
/// Hansen and Walster, "Global Optimization Using Interval Analysis", 2004). What it drops is proved to be
/// empty, so that whatever it returns, and whenever it stops, the surface does not reach beyond.
class EndSearch {
 public:
  /// The surface's least coordinate along `axis`, or its greatest. `tolerance`: in parts of the region.
  EndSearch(const QuadricField& field, int axis, bool greatest, double tolerance)
      : field_(field), axis_(axis), greatest_(greatest), tolerance_(tolerance) {
    const Box& region = field.region();
    size_ = region.high - region.low;
  }

  /// Nothing where the surface does not meet the region.
  std::optional<double> run() {
    add(field_.region(), 0);
    for (int looked_at = 0; !open_.empty(); ++looked_at) {
      std::ranges::pop_heap(open_, Later{});
      const Part part = open_.back();
      open_.pop_back();
      const int across = widest(part.box);
      if (across < 0 || looked_at == most_looked_at || reaches_end_of(part.box)) return end_of(part.box);
      const double middle = 0.5 * (part.box.low[across] + part.box.high[across]);
      Box lower = part.box, upper = part.box;
      lower.high[across] = middle, upper.low[across] = middle;
      add(lower, part.depth + 1);
      add(upper, part.depth + 1);
    }
    return std::nullopt;
  }

 private:
  struct Part {
    Box box;
    int depth;
    double end;  // the coordinate up to which it reaches, negative when the greatest is looked for
  };
  /// The order of the heap: the part nearest to the end on top, of equally near ones the smallest.
  struct Later {
    bool operator()(const Part& a, const Part& b) const {
      return a.end != b.end ? a.end > b.end : a.depth < b.depth;
    }
  };

  double end_of(const Box& box) const { return greatest_ ? box.high[axis_] : box.low[axis_]; }

  void add(const Box& box, int depth) {
    if (field_.certainly_misses(box)) return;
    open_.push_back({box, depth, greatest_ ? -end_of(box) : end_of(box)});
    std::ranges::push_heap(open_, Later{});
  }

  /// The axis across which to split, or -1 where the part is small enough. Seen from its end a smooth surface
  /// rises as the square of the distance, so parts are as flat.
  int widest(const Box& box) const {
    int best = -1;
    double most = 0;
    for (int i = 0; i < 3; ++i) {
      const double width = size_[i] > 0 ? (box.high[i] - box.low[i]) / size_[i] : 0;
      if (width <= tolerance_) continue;
      const double share = i == axis_ ? width : width * width;
      if (share > most || (share == most && i == axis_)) best = i, most = share;
    }
    return best;
  }

  /// The surface passes through the part's face at the end: nothing is to be gained. (A guess in double; a
  /// wrong one does no harm.)
  bool reaches_end_of(const Box& box) const {
    bool below = false, above = false;
    for (unsigned corner = 0; corner < 4; ++corner) {
      Vec3d p;
      p[axis_] = end_of(box);
      for (int k = 1; k <= 2; ++k) {
        const int i = (axis_ + k) % 3;
        p[i] = corner & static_cast<unsigned>(k) ? box.high[i] : box.low[i];
      }
      const double value = field_.value(p);
      below |= value < 0, above |= value > 0;
    }
    return below && above;
  }

  static constexpr int most_looked_at = 4096;

  const QuadricField& field_;
  int axis_;
  bool greatest_;
  double tolerance_;
  Vec3d size_;
  std::vector<Part> open_;
};

/// Makes the field's region smaller from all six sides; false where the surface does not meet it.
bool shrink(QuadricField& field, double tolerance) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool greatest : {false, true}) {
      const std::optional<double> end = EndSearch(field, axis, greatest, tolerance).run();
      if (!end) return false;
      Box region = field.region();
      (greatest ? region.high : region.low)[axis] = *end;
      field.shrink_to(region);
    }
  return true;
}

bool halved(const Vec3d& before, const Vec3d& after) {
  return 2 * after.x < before.x || 2 * after.y < before.y || 2 * after.z < before.z;
}

}  // namespace

bool is_finite(const GeneralQuadric& quadric) {
  return is_finite(quadric.centre) && is_finite(quadric.clip.low) && is_finite(quadric.clip.high) &&
         std::ranges::all_of(quadric.coefficients, [](float x) { return std::isfinite(x); });
}

Bounds bounds_of(const GeneralQuadric& quadric) {
  if (!is_finite(quadric)) return {};
  for (int axis = 0; axis < 3; ++axis)
    if (quadric.clip.low[axis] > quadric.clip.high[axis]) return {};

  // Roughly at first, again and again where the clip box is much larger than the surface.
  constexpr double rough = 0x1p-3, fine = 0x1p-12;
  QuadricField field(quadric);
  const auto size = [&] { return field.region().high - field.region().low; };
  Vec3d before;
  do {
    before = size();
    if (!shrink(field, rough)) return {};
  } while (halved(before, size()));
  if (!shrink(field, fine)) return {};

  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = field.centre()[axis], low = field.region().low[axis],
                 high = field.region().high[axis];
    const double margin = 0x1p-48 * (std::abs(centre) + std::max(std::abs(low), std::abs(high)));
    box.low[axis] = std::max(flushed(quadric.clip.low[axis]), float_below(centre + low - margin));
    box.high[axis] = std::min(flushed(quadric.clip.high[axis]), -float_below(-(centre + high + margin)));
  }
  return box;
}

}  // namespace raymeter
