#pragma once
// A walker that shares nothing with the real ones: all crossings of a ray with all planes, sorted.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scenes/geometry/ray.h"
#include "scenes/geometry/vec3.h"

namespace raymeter {

struct SlowGrid {
  std::array<long double, 3> low, high;
  std::array<std::uint32_t, 3> n;

  long double plane(std::size_t axis, std::uint32_t i) const {
    return low[axis] + (high[axis] - low[axis]) * i / n[axis];
  }
};

struct SlowCell {
  std::array<std::uint32_t, 3> index;
  long double enter, leave;
};

/// The cells that the line pierces with t in begin..end, in order.
inline std::vector<SlowCell> slow_walk(const SlowGrid& grid, const Ray& ray, long double begin,
                                       long double end) {
  // Clip to the box.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const long double o = ray.origin[int(axis)], d = ray.direction[int(axis)];
    const long double a = (grid.low[axis] - o) / d, b = (grid.high[axis] - o) / d;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  std::vector<SlowCell> cells;
  if (begin > end) return cells;
  // Between two neighbouring crossings the ray is in one cell.
  std::vector<long double> crossings{begin, end};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 1; i < grid.n[axis]; ++i) {
      const long double t = (grid.plane(axis, i) - ray.origin[int(axis)]) / ray.direction[int(axis)];
      if (t > begin && t < end) crossings.push_back(t);
    }
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t c = 0; c + 1 < crossings.size(); ++c) {
    const long double middle = (crossings[c] + crossings[c + 1]) / 2;
    SlowCell cell{{}, crossings[c], crossings[c + 1]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const long double p = ray.origin[int(axis)] + middle * ray.direction[int(axis)];
      while (cell.index[axis] + 1 < grid.n[axis] && p >= grid.plane(axis, cell.index[axis] + 1))
        ++cell.index[axis];
    }
    cells.push_back(cell);
  }
  return cells;
}

/// Whether the cell, grown by `margin`, meets the box.
inline bool slow_overlap(const SlowGrid& grid, const std::array<std::uint32_t, 3>& index, const Bounds& box,
                         long double margin) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (box.high[int(axis)] < grid.plane(axis, index[axis]) - margin ||
        box.low[int(axis)] > grid.plane(axis, index[axis] + 1) + margin)
      return false;
  return true;
}

}  // namespace raymeter
