#pragma once
#include <array>
#include <cstdint>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// Cells along each axis.
using Resolution = std::array<std::uint32_t, 3>;

inline std::uint64_t cell_count(const Resolution& n) {
  return std::uint64_t{n[0]} * n[1] * n[2];
}

/// A box cut into equal cells, x varying fastest in the numbering.
struct CellGrid {
  Vec3d low, size, inverse_size;  ///< size: of one cell
  Resolution n{1, 1, 1};

  CellGrid() = default;
  /// The box must be nowhere flat (see WalkSpace).
  CellGrid(const Vec3d& box_low, const Vec3d& box_high, const Resolution& resolution)
      : low(box_low), n(resolution) {
    for (int axis = 0; axis < 3; ++axis) {
      size[axis] = (box_high[axis] - box_low[axis]) / n[axis];
      inverse_size[axis] = n[axis] / (box_high[axis] - box_low[axis]);
    }
  }

  std::uint64_t cell(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return i + n[0] * (j + std::uint64_t{n[1]} * k);
  }
  /// The position of the plane below index i; a function of i alone.
  double plane(int axis, double i) const { return low[axis] + i * size[axis]; }
  /// The index of the layer that holds `position`, or the nearest one.
  std::uint32_t layer(int axis, double position) const {
    const double x = (position - low[axis]) * inverse_size[axis];
    if (!(x > 0)) return 0;
    return x < n[axis] ? static_cast<std::uint32_t>(x) : n[axis] - 1;
  }
};

}  // namespace raymeter
