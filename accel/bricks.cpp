#include "accel/bricks.h"

#include <cmath>
#include <limits>

#include "scenes/base/error.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {

FloatGrid::FloatGrid(const CellGrid& grid) {
  double squares = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = grid.plane(axis, grid.n[static_cast<std::size_t>(axis)]) - grid.low[axis];
    squares += extent * extent;
  }
  const double diagonal = std::sqrt(squares);
  const bool walkable = diagonal > 0x1p-60 && diagonal < 0x1p60;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::int32_t cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const double box_low = grid.low[axis], box_high = grid.plane(axis, grid.n[a]);
    low[a] = static_cast<float>(box_low);
    size[a] = static_cast<float>(grid.size[axis]);
    inverse_size[a] = static_cast<float>(grid.inverse_size[axis]);
    layers[a] = static_cast<float>(grid.n[a]);
    nearby_low[a] = walkable ? static_cast<float>(box_low - 4 * diagonal) : infinity;
    nearby_high[a] = walkable ? static_cast<float>(box_high + 4 * diagonal) : -infinity;
    cell_reach += size[a] + 0x1p-12f * static_cast<float>(diagonal);
    stride[a] = cells;
    cells *= static_cast<std::int32_t>(grid.n[a]);
  }
}

WalkSpace float_walk_space(const Scene& scene, const std::string& structure) {
  const Bounds box = scene.bounds();
  // Of the coordinates for what is moved to where it enters, which is rounded to floats (trace_from_afar).
  WalkSpace space(box.empty() ? Bounds{{0, 0, 0}, {0, 0, 0}} : box, 0x1p-17, 0x1p-22);
  for (int axis = 0; axis < 3; ++axis) {
    space.low[axis] = float_below(space.low[axis]);
    if (std::max(-space.low[axis], space.high[axis]) > 0x1p126)
      throw Error(structure + ": coordinates beyond 8.5e+37 would leave the range of floats");
  }
  return space;
}

}  // namespace raymeter
