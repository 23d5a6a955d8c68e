#include "accel/two_level_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "accel/note.h"
#include "accel/parallel.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// What the sub-grids have together.
struct Layout {
  std::uint64_t cells = 0, clamped = 0, work = 0;
  friend Layout operator+(const Layout& a, const Layout& b) {
    return {a.cells + b.cells, a.clamped + b.clamped, a.work + b.work};
  }
};

}  // namespace

TwoLevelCells::TwoLevelCells(const Scene& scene, const WalkSpace& space, const ResolutionLimits& limits,
                             std::uint64_t most_work, const TwoLevelOptions& options, MemoryMeter& meter)
    : scene_(scene),
      margin_(space.margin),
      top_lists_(meter),
      leaf_lists_(meter),
      subgrid_of_(MeteredAllocator<std::uint32_t>(meter)),
      subgrids_(MeteredAllocator<SubGrid>(meter)) {
  // Register every primitive in the cells of the top level.
  auto chosen = choose_resolution(options.top, shape_sizes(scene), limits);
  grid_ = registrable_grid(scene, space, most_work, chosen);
  note_ = chosen.note;
  top_lists_.build(cell_count(chosen.n), scene.primitive_count(), [&](std::uint32_t p, const auto& add) {
    for_each_cell_of(scene, p, grid_, margin_, options.fit, add);
  });

  // Give each crowded cell a grid, and register the cell's primitives again in that.
  const std::uint64_t leaf_cells = lay_out_subgrids(options, limits, most_work);
  leaf_lists_.build_by_groups(leaf_cells, top_lists_.cells(), [&](std::uint64_t top, const auto& add) {
    if (subgrid_of_[top] == no_subgrid) return;
    const SubGrid& sub = subgrids_[subgrid_of_[top]];
    for (const std::uint32_t p : top_lists_[top])
      for_each_cell_of(scene, p, sub.grid, margin_, options.fit,
                       [&](std::uint64_t c) { add(sub.first_cell + c, p); });
  });
  top_lists_.drop([this](std::uint64_t top) { return subgrid_of_[top] != no_subgrid; });
}

StructureStats TwoLevelCells::stats() const {
  StructureStats stats;
  stats.note = note_;
  stats.resolution = grid_.n;
  stats.inner_nodes = subgrids_.size();
  stats.cells = top_lists_.cells() - subgrids_.size() + leaf_lists_.cells();
  stats.empty_cells = top_lists_.empty_cells() - subgrids_.size() + leaf_lists_.empty_cells();
  stats.references = top_lists_.references() + leaf_lists_.references();
  stats.depth = subgrids_.empty() ? 1 : 2;
  return stats;
}

/// Fills subgrid_of_ and subgrids_; gives the number of their cells.
std::uint64_t TwoLevelCells::lay_out_subgrids(const TwoLevelOptions& options, const ResolutionLimits& limits,
                                              std::uint64_t most_work) {
  subgrid_of_.assign(top_lists_.cells(), no_subgrid);
  std::uint32_t crowded = 0;
  for (std::uint64_t c = 0; c < top_lists_.cells(); ++c)
    if (top_lists_[c].size() > options.threshold) subgrid_of_[c] = crowded++;
  subgrids_.resize(crowded);

  // When all sub-grids together have too many cells, or look at too many while registering, make all of
  // them coarser.
  ResolutionRule leaf = options.leaf;
  while (true) {
    // Each sub-grid by itself; `first_cell` holds how many cells it has, until all are known.
    const auto total =
        sum_of_ranges<Layout>(top_lists_.cells(), 1024, [&](std::uint64_t begin, std::uint64_t end) {
          Layout part;
          for (std::uint64_t c = begin; c < end; ++c) {
            if (subgrid_of_[c] == no_subgrid) continue;
            CellBox box = box_of(c);
            if (options.begin_at_floats)
              for (int axis = 0; axis < 3; ++axis) box.low[axis] = float_below(box.low[axis]);
            const auto chosen = choose_resolution(leaf, sizes_in(box, top_lists_[c]), limits);
            const CellGrid grid(box.low, box.high, chosen.n);
            subgrids_[subgrid_of_[c]] = {grid, cell_count(chosen.n)};
            part.cells += cell_count(chosen.n);
            part.clamped += chosen.clamped;
            for (const std::uint32_t p : top_lists_[c])
              part.work += cells_of_box(grid, scene_.bounds_of(p), margin_).cells();
          }
          return part;
        });
    if (total.cells <= limits.cells && total.work <= most_work) {
      std::uint64_t first_cell = 0;
      for (SubGrid& sub : subgrids_) sub.first_cell = std::exchange(first_cell, first_cell + sub.first_cell);
      if (leaf.value != options.leaf.value)
        add_note(
            note_,
            fmt::format("leaf-density clamped from {} to {} (limit {} cells, {} in all primitives' boxes)",
                        options.leaf.value, leaf.value, limits.cells, most_work));
      if (total.clamped) add_note(note_, fmt::format("{} sub-grids clamped", total.clamped));
      return total.cells;
    }
    leaf.value /= 2;
  }
}

TwoLevelCells::CellBox TwoLevelCells::box_of(std::uint64_t cell) const {
  const std::array<std::uint64_t, 3> index{cell % grid_.n[0], cell / grid_.n[0] % grid_.n[1],
                                           cell / grid_.n[0] / grid_.n[1]};
  CellBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = double(index[std::size_t(axis)]);
    box.low[axis] = grid_.plane(axis, i) - margin_;
    box.high[axis] = grid_.plane(axis, i + 1) + margin_;
  }
  return box;
}

/// Of the parts of the primitives' boxes that lie in `box`.
ShapeSizes TwoLevelCells::sizes_in(const CellBox& box, std::span<const std::uint32_t> primitives) const {
  ShapeSizes sizes;
  sizes.count = primitives.size();
  sizes.extent = box.high - box.low;
  Vec3d sum;
  for (const std::uint32_t p : primitives) {
    const Bounds bounds = scene_.bounds_of(p);
    for (int axis = 0; axis < 3; ++axis)
      sum[axis] += std::max(0.0, std::min(double(bounds.high[axis]), box.high[axis]) -
                                     std::max(double(bounds.low[axis]), box.low[axis]));
  }
  sizes.mean_extent = (1 / double(sizes.count)) * sum;
  return sizes;
}

}  // namespace raymeter
