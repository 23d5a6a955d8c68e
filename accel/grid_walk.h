#pragma once
#include <algorithm>
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
  struct Axis {
    double next;              // t at which the plane ahead is crossed
    double plane, step;       // its index, and +1 or -1
    double first, delta;      // t at plane 0, and from plane to plane
    std::uint64_t stride;     // from cell to cell, modulo 2^64
    std::uint32_t remaining;  // layers ahead

    /// False where the plane ahead bounds the grid.
    bool cross() {
      if (remaining == 0) return false;
      --remaining;
      plane += step;
      next = first + plane * delta;
      return true;
    }
  };

  // Find the cell where the interval begins and, on each axis, the plane that the ray crosses next.
  std::uint64_t cell = 0;
  const auto begin = [&](int axis, std::uint64_t stride) {
    const double d = walk.direction[axis];
    const std::uint32_t layer = grid.layer(axis, walk.origin[axis] + interval.enter * d);
    cell += stride * layer;
    const bool up = d > 0;
    Axis a;
    a.step = up ? 1 : -1;
    a.stride = up ? stride : -stride;
    a.remaining = up ? grid.n[std::size_t(axis)] - 1 - layer : layer;
    a.plane = up ? layer + 1.0 : layer;
    // A ray along the planes never crosses one.
    a.first = d == 0 ? std::numeric_limits<double>::infinity()
                     : (grid.low[axis] - walk.origin[axis]) * walk.inverse[axis];
    a.delta = d == 0 ? 0 : grid.size[axis] * walk.inverse[axis];
    a.next = a.first + a.plane * a.delta;
    return a;
  };
  Axis x = begin(0, 1), y = begin(1, grid.n[0]), z = begin(2, std::uint64_t{grid.n[0]} * grid.n[1]);

  double enter = interval.enter;
  while (true) {
    // The ray leaves the cell where it crosses the nearest of the three planes ahead.
    const double leave = std::min(std::min(x.next, y.next), z.next);
    if (leave > visit(cell, enter, std::min(leave, interval.leave))) return;
    // Step across that plane, unless it bounds the grid.
    if (x.next == leave) {
      if (!x.cross()) return;
      cell += x.stride;
    } else if (y.next == leave) {
      if (!y.cross()) return;
      cell += y.stride;
    } else {
      if (!z.cross()) return;
      cell += z.stride;
    }
    enter = leave;
  }
}

}  // namespace raymeter
