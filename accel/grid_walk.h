#pragma once
#include <cstdint>
#include <limits>

#include "accel/cell_grid.h"
#include "accel/walk_space.h"

namespace raymeter {

/// Calls visit(cell, enter, leave) for the cells that the ray pierces within `interval`, in order, with the
/// part of the interval inside each. `visit` returns the t beyond which nothing matters to it any more: the
/// walk goes on while the next cell is entered at that t or before.
///
/// A 3DDDA (Fujimoto, Tanaka, Iwata 1986) in the form of Amanatides & Woo 1987: the plane crossed next is the
/// nearest of three. Unlike theirs the crossings are not accumulated, so that walk_space.h's proof holds: a
/// plane of index k is crossed at first + k * delta, within 2^-51 * (distance of its box's corner + extent).
template <class Visit>
inline void walk_cells(const CellGrid& grid, const WalkRay& walk, const WalkInterval& interval,
                       Visit&& visit) {
  double first[3], delta[3], plane[3], next[3], step[3];
  std::uint64_t stride[3];
  std::uint32_t remaining[3];  // layers ahead on each axis
  const std::uint64_t strides[3] = {1, grid.n[0], std::uint64_t{grid.n[0]} * grid.n[1]};
  std::uint64_t cell = 0;

  // Find the cell where the interval begins and, on each axis, the plane that the ray crosses next.
  for (int axis = 0; axis < 3; ++axis) {
    const double d = walk.direction[axis];
    const std::uint32_t layer = grid.layer(axis, walk.origin[axis] + interval.enter * d);
    cell += strides[axis] * layer;
    const bool up = d > 0;
    step[axis] = up ? 1 : -1;
    stride[axis] = up ? strides[axis] : -strides[axis];
    remaining[axis] = up ? grid.n[axis] - 1 - layer : layer;
    plane[axis] = up ? layer + 1.0 : layer;
    if (d == 0) {  // never crosses a plane
      first[axis] = std::numeric_limits<double>::infinity();
      delta[axis] = 0;
    } else {
      first[axis] = (grid.low[axis] - walk.origin[axis]) * walk.inverse[axis];
      delta[axis] = grid.size[axis] * walk.inverse[axis];
    }
    next[axis] = first[axis] + plane[axis] * delta[axis];
  }

  double enter = interval.enter;
  while (true) {
    // The ray leaves the cell where it crosses the nearest of the three planes ahead.
    const int lesser = next[1] < next[0] ? 1 : 0;
    const int axis = next[2] < next[lesser] ? 2 : lesser;
    const double leave = next[axis];
    if (leave > visit(cell, enter, leave < interval.leave ? leave : interval.leave)) return;
    // Step across that plane, unless it bounds the grid.
    if (remaining[axis]-- == 0) return;
    cell += stride[axis];
    plane[axis] += step[axis];
    next[axis] = first[axis] + plane[axis] * delta[axis];
    enter = leave;
  }
}

}  // namespace raymeter
