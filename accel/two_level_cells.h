#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "accel/cell_grid.h"
#include "accel/cell_lists.h"
#include "accel/cell_overlap.h"
#include "accel/grid_resolution.h"
#include "accel/memory_meter.h"
#include "accel/structure.h"
#include "accel/walk_space.h"
#include "scenes/scene.h"

namespace raymeter {

struct TwoLevelOptions {
  ResolutionRule top, leaf;
  std::uint64_t threshold = 0;  ///< a cell with more primitives gets a grid of its own
  Fit fit = Fit::exact;
  bool begin_at_floats = false;  ///< sub-grids, as BrickWalk needs it
};

/// The grid of one crowded cell. It covers the cell's box grown by the margin, so that a ray leaves the cell
/// before it leaves the sub-grid, whatever the rounding.
struct SubGrid {
  CellGrid grid;
  std::uint64_t first_cell = 0;  ///< of its cells in the lists that all sub-grids share
};

/// A uniform grid whose crowded cells are cut by grids of their own (Jevans & Wyvill, "Adaptive Voxel
/// Subdivision for Ray Tracing", 1989), and which primitives each cell holds.
class TwoLevelCells {
 public:
  static constexpr std::uint32_t no_subgrid = std::numeric_limits<std::uint32_t>::max();

  /// Primitives are registered in each cell that they come as near to as the margin of `space`. `most_work`:
  /// in how many cells their boxes may lie. Throws MemoryLimitExceeded.
  TwoLevelCells(const Scene& scene, const WalkSpace& space, const ResolutionLimits& limits,
                std::uint64_t most_work, const TwoLevelOptions& options, MemoryMeter& meter);

  const CellGrid& grid() const { return grid_; }
  /// Of the cells of the upper grid; empty for those with a sub-grid.
  const CellLists& top_lists() const { return top_lists_; }
  /// Of the cells of all sub-grids.
  const CellLists& leaf_lists() const { return leaf_lists_; }
  std::span<const SubGrid> subgrids() const { return subgrids_; }
  /// Index of a cell's sub-grid, or no_subgrid.
  std::uint32_t subgrid_of(std::uint64_t top) const { return subgrid_of_[top]; }

  /// All but the bytes.
  StructureStats stats() const;
  std::uint64_t top_bytes() const {
    return top_lists_.offset_bytes() + subgrid_of_.capacity() * sizeof(std::uint32_t);
  }
  std::uint64_t subgrid_bytes() const { return subgrids_.capacity() * sizeof(SubGrid); }

 private:
  struct CellBox {
    Vec3d low, high;
  };
  std::uint64_t lay_out_subgrids(const TwoLevelOptions& options, const ResolutionLimits& limits,
                                 std::uint64_t most_work);
  CellBox box_of(std::uint64_t cell) const;
  ShapeSizes sizes_in(const CellBox& box, std::span<const std::uint32_t> primitives) const;

  const Scene& scene_;
  double margin_;
  CellLists top_lists_, leaf_lists_;
  MeteredVector<std::uint32_t> subgrid_of_;  // by top cell
  MeteredVector<SubGrid> subgrids_;
  CellGrid grid_;
  std::string note_;
};

}  // namespace raymeter
