#include "scenes/geometry/polygon_cutter.h"

#include <algorithm>
#include <cmath>

namespace raymeter {
namespace {

/// The sign of a sum of doubles, exactly: a non-overlapping expansion grown by one term at a time, whose
/// largest component has the sum's sign (Shewchuk 1997, Grow-Expansion).
template <std::size_t n>
int sign_of_sum(const std::array<double, n>& terms) {
  std::array<double, n> expansion{};
  for (std::size_t size = 0; size < n; ++size) {
    double sum = terms[size];
    for (std::size_t i = 0; i < size; ++i) {
      const double a = sum, b = expansion[i];
      sum = a + b;
      const double b_part = sum - a, a_part = sum - b_part;
      expansion[i] = (a - a_part) + (b - b_part);
    }
    expansion[size] = sum;
  }
  for (std::size_t i = n; i-- > 0;)
    if (expansion[i] != 0) return expansion[i] > 0 ? 1 : -1;
  return 0;
}

/// Twice the polygon's area vector (Newell's normal), taken from its first corner.
Vec3d area_vector(std::span<const Vec3> corners) {
  Vec3d sum;
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum = sum + cross(to_double(corners[i - 1]) - to_double(corners[0]),
                      to_double(corners[i]) - to_double(corners[0]));
  return sum;
}

}  // namespace

int PolygonCutter::orientation(const Point& a, const Point& b, const Point& c) {
  const double left = (double(b.x) - a.x) * (double(c.y) - a.y),
               right = (double(b.y) - a.y) * (double(c.x) - a.x), difference = left - right;
  // Both are 0 only where a difference of two floats is, and that is exact.
  if (left == 0 && right == 0) return 0;
  // Three roundings in each product and one in the difference: Shewchuk's bound is (3 + 16e) e, e = 2^-53.
  if (std::abs(difference) > 4e-16 * (std::abs(left) + std::abs(right))) return difference > 0 ? 1 : -1;
  // The products of floats are exact in double, and so is the sign of their sum.
  return sign_of_sum(std::array<double, 6>{double(a.x) * b.y, -double(a.y) * b.x, double(b.x) * c.y,
                                           -double(b.y) * c.x, double(c.x) * a.y, -double(c.y) * a.x});
}

bool PolygonCutter::cut(std::span<const Vec3> corners) {
  const std::size_t count = corners.size();
  triangles_.clear();

  // Drop the axis along which the polygon is seen largest.
  int axis = 0;
  Vec3d normal;
  if (count > 3) {
    normal = area_vector(corners);
    for (int other = 1; other < 3; ++other)
      if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
    points_.clear();
    for (const Vec3& corner : corners) points_.push_back({corner[(axis + 1) % 3], corner[(axis + 2) % 3]});
  }

  // A fan where it is right; where nothing is (no area), it is as good as anything.
  if (count <= 3 || normal[axis] == 0 || fan_tiles()) {
    for (std::uint32_t i = 2; i < count; ++i) triangles_.push_back({0, i - 1, i});
    return true;
  }
  if (count > most_clipped_corners) return false;
  clip_ears(normal[axis] > 0 ? 1 : -1);
  return true;
}

bool PolygonCutter::fan_tiles() const {
  // Seen from its first corner, a simple polygon whose boundary never turns back is a fan.
  bool left = false, right = false;
  for (std::size_t i = 2; i < points_.size(); ++i) {
    const int turn = orientation(points_[0], points_[i - 1], points_[i]);
    left |= turn > 0;
    right |= turn < 0;
  }
  return !(left && right);
}

void PolygonCutter::clip_ears(int sense) {
  const auto count = static_cast<std::uint32_t>(points_.size());
  previous_.resize(count);
  next_.resize(count);
  turn_.resize(count);
  ear_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    previous_[i] = (i + count - 1) % count;
    next_[i] = (i + 1) % count;
  }
  for (std::uint32_t i = 0; i < count; ++i)
    turn_[i] =
        static_cast<std::int8_t>(sense * orientation(points_[previous_[i]], points_[i], points_[next_[i]]));
  for (std::uint32_t i = 0; i < count; ++i) ear_[i] = is_ear(i, sense);

  // Cut off one corner after the other, until a triangle is left.
  std::uint32_t start = 0;
  for (std::uint32_t remaining = count; remaining > 3; --remaining) {
    const std::uint32_t corner = find_ear(start, remaining), before = previous_[corner],
                        after = next_[corner];
    triangles_.push_back({before, corner, after});
    next_[before] = after;
    previous_[after] = before;
    // Only the two neighbours can become ears by this or cease to be.
    classify(before, sense);
    classify(after, sense);
    start = next_[after];
  }
  triangles_.push_back({previous_[start], start, next_[start]});
}

std::uint32_t PolygonCutter::find_ear(std::uint32_t start, std::size_t remaining) const {
  // In a simple polygon there is always an ear. In others take, in this order, a corner that bounds no area,
  // one that turns the right way, any.
  std::uint32_t best = start;
  int best_rank = 0;
  for (std::uint32_t i = start; remaining-- > 0; i = next_[i]) {
    if (ear_[i]) return i;
    const int rank = turn_[i] == 0 ? 2 : turn_[i] > 0 ? 1 : 0;
    if (rank > best_rank) {
      best = i;
      best_rank = rank;
    }
  }
  return best;
}

void PolygonCutter::classify(std::uint32_t corner, int sense) {
  turn_[corner] = static_cast<std::int8_t>(
      sense * orientation(points_[previous_[corner]], points_[corner], points_[next_[corner]]));
  ear_[corner] = is_ear(corner, sense);
}

bool PolygonCutter::is_ear(std::uint32_t corner, int sense) const {
  if (turn_[corner] <= 0) return false;
  const std::uint32_t before = previous_[corner], after = next_[corner];
  const Point &a = points_[before], &b = points_[corner], &c = points_[after];
  // No other corner may lie in the triangle. If any does, one that isn't convex does. Corners in the same
  // place as the triangle's (a hole reached by a cut along a line) don't count.
  for (std::uint32_t i = next_[after]; i != before; i = next_[i]) {
    if (turn_[i] > 0) continue;
    const Point& p = points_[i];
    if (p == a || p == b || p == c) continue;
    if (sense * orientation(a, b, p) >= 0 && sense * orientation(b, c, p) >= 0 &&
        sense * orientation(c, a, p) >= 0)
      return false;
  }
  return true;
}

}  // namespace raymeter
