#include "accel/two_level_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "accel/cell_lists.h"
#include "accel/cell_overlap.h"
#include "accel/cell_query.h"
#include "accel/grid_resolution.h"
#include "accel/grid_walk.h"
#include "accel/note.h"
#include "accel/parallel.h"
#include "accel/per_ray_structure.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

struct Options {
  ResolutionRule top, leaf;
  std::uint64_t threshold = 0;
  Fit fit = Fit::exact;
};

/// The grid of one crowded cell. It covers the cell's box grown by the margin, so that a ray leaves the cell
/// before it leaves the sub-grid, whatever the rounding.
struct SubGrid {
  CellGrid grid;
  std::uint64_t first_cell = 0;  // of its cells in the lists that all sub-grids share
};

constexpr std::uint32_t no_subgrid = std::numeric_limits<std::uint32_t>::max();

class TwoLevelGrid final : public PerRayStructure<TwoLevelGrid> {
 public:
  TwoLevelGrid(const BuildInput& input, const Options& options)
      : PerRayStructure(input.scene),
        meter_(input.memory_limit),
        top_lists_(meter_),
        leaf_lists_(meter_),
        subgrid_of_(MeteredAllocator<std::uint32_t>(meter_)),
        subgrids_(MeteredAllocator<SubGrid>(meter_)) {
    const Scene& scene = input.scene;
    space_ = walk_space_of(scene);
    const auto limits = ResolutionLimits::within(input.memory_limit, 4 * space_.margin);
    auto chosen = choose_resolution(options.top, shape_sizes(scene), limits);

    // Register every primitive in the cells of the top level.
    grid_ = registrable_grid(scene, space_, registration_limit(scene.primitive_count()), chosen);
    stats_.note = chosen.note;
    top_lists_.build(cell_count(chosen.n), scene.primitive_count(), [&](std::uint32_t p, const auto& add) {
      for_each_cell_of(scene, p, grid_, space_.margin, options.fit, add);
    });

    // Give each crowded cell a grid, and register the cell's primitives again in that.
    const std::uint64_t leaf_cells = lay_out_subgrids(options, limits);
    leaf_lists_.build_by_groups(leaf_cells, top_lists_.cells(), [&](std::uint64_t top, const auto& add) {
      if (subgrid_of_[top] == no_subgrid) return;
      const SubGrid& sub = subgrids_[subgrid_of_[top]];
      for (const std::uint32_t p : top_lists_[top])
        for_each_cell_of(scene, p, sub.grid, space_.margin, options.fit,
                         [&](std::uint64_t c) { add(sub.first_cell + c, p); });
    });
    top_lists_.drop([this](std::uint64_t top) { return subgrid_of_[top] != no_subgrid; });

    stats_.resolution = chosen.n;
    stats_.inner_nodes = subgrids_.size();
    stats_.cells = top_lists_.cells() - subgrids_.size() + leaf_lists_.cells();
    stats_.empty_cells = top_lists_.empty_cells() - subgrids_.size() + leaf_lists_.empty_cells();
    stats_.references = top_lists_.references() + leaf_lists_.references();
    stats_.depth = subgrids_.empty() ? 1 : 2;
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {
        {"top_cells", top_lists_.offset_bytes() + subgrid_of_.capacity() * sizeof(std::uint32_t)},
        {"top_references", top_lists_.reference_bytes()},
        {"sub-grids", subgrids_.capacity() * sizeof(SubGrid)},
        {"leaf_cells", leaf_lists_.offset_bytes()},
        {"leaf_references", leaf_lists_.reference_bytes()}};
  }

  StructureStats stats() const override { return stats_; }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return answer<ClosestQuery<NoMailbox, Probe>>(ray, probe);
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return answer<AnyQuery<NoMailbox, Probe>>(ray, probe);
  }

 private:
  template <class Query, class Probe>
  typename Query::Answer answer(const Ray& ray, Probe& probe) const {
    return answer_by_walk<Query>(
        scene(), space_, ray, probe,
        [this, &probe](const WalkRay& walk, const WalkInterval& interval, Query& query) {
          walk_cells(grid_, walk, interval, [&](std::uint64_t top, double enter, double leave) {
            if (subgrid_of_[top] == no_subgrid) {
              query.visit(top_lists_[top]);
              return query.last();
            }
            // Walk the cell's own grid, from where the ray enters the cell to where it leaves it.
            probe.inner_step();
            probe.enter_subgrid();
            const SubGrid& sub = subgrids_[subgrid_of_[top]];
            walk_cells(sub.grid, walk, {enter, leave}, [&](std::uint64_t cell, double, double) {
              query.visit(leaf_lists_[sub.first_cell + cell]);
              return std::min(leave, query.last());
            });
            return query.last();
          });
        });
  }

  /// What the sub-grids have together.
  struct Layout {
    std::uint64_t cells = 0, clamped = 0, work = 0;
    friend Layout operator+(const Layout& a, const Layout& b) {
      return {a.cells + b.cells, a.clamped + b.clamped, a.work + b.work};
    }
  };

  /// Fills subgrid_of_ and subgrids_; gives the number of their cells.
  std::uint64_t lay_out_subgrids(const Options& options, const ResolutionLimits& limits) {
    subgrid_of_.assign(top_lists_.cells(), no_subgrid);
    std::uint32_t crowded = 0;
    for (std::uint64_t c = 0; c < top_lists_.cells(); ++c)
      if (top_lists_[c].size() > options.threshold) subgrid_of_[c] = crowded++;
    subgrids_.resize(crowded);

    // When all sub-grids together have too many cells, or look at too many while registering, make all of
    // them coarser.
    const std::uint64_t work_limit = registration_limit(scene().primitive_count());
    ResolutionRule leaf = options.leaf;
    while (true) {
      // Each sub-grid by itself; `first_cell` holds how many cells it has, until all are known.
      const auto total =
          sum_of_ranges<Layout>(top_lists_.cells(), 1024, [&](std::uint64_t begin, std::uint64_t end) {
            Layout part;
            for (std::uint64_t c = begin; c < end; ++c) {
              if (subgrid_of_[c] == no_subgrid) continue;
              const CellBox box = box_of(c);
              const auto chosen = choose_resolution(leaf, sizes_in(box, top_lists_[c]), limits);
              const CellGrid grid(box.low, box.high, chosen.n);
              subgrids_[subgrid_of_[c]] = {grid, cell_count(chosen.n)};
              part.cells += cell_count(chosen.n);
              part.clamped += chosen.clamped;
              for (const std::uint32_t p : top_lists_[c])
                part.work += cells_of_box(grid, scene().bounds_of(p), space_.margin).cells();
            }
            return part;
          });
      if (total.cells <= limits.cells && total.work <= work_limit) {
        std::uint64_t first_cell = 0;
        for (SubGrid& sub : subgrids_)
          sub.first_cell = std::exchange(first_cell, first_cell + sub.first_cell);
        if (leaf.value != options.leaf.value)
          add_note(
              stats_.note,
              fmt::format("leaf-density clamped from {} to {} (limit {} cells, {} in all primitives' boxes)",
                          options.leaf.value, leaf.value, limits.cells, work_limit));
        if (total.clamped) add_note(stats_.note, fmt::format("{} sub-grids clamped", total.clamped));
        return total.cells;
      }
      leaf.value /= 2;
    }
  }

  struct CellBox {
    Vec3d low, high;
  };
  CellBox box_of(std::uint64_t cell) const {
    const std::array<std::uint64_t, 3> index{cell % grid_.n[0], cell / grid_.n[0] % grid_.n[1],
                                             cell / grid_.n[0] / grid_.n[1]};
    CellBox box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = double(index[std::size_t(axis)]);
      box.low[axis] = grid_.plane(axis, i) - space_.margin;
      box.high[axis] = grid_.plane(axis, i + 1) + space_.margin;
    }
    return box;
  }

  /// Of the parts of the primitives' boxes that lie in `box`.
  ShapeSizes sizes_in(const CellBox& box, std::span<const std::uint32_t> primitives) const {
    ShapeSizes sizes;
    sizes.count = primitives.size();
    sizes.extent = box.high - box.low;
    Vec3d sum;
    for (const std::uint32_t p : primitives) {
      const Bounds bounds = scene().bounds_of(p);
      for (int axis = 0; axis < 3; ++axis)
        sum[axis] += std::max(0.0, std::min(double(bounds.high[axis]), box.high[axis]) -
                                       std::max(double(bounds.low[axis]), box.low[axis]));
    }
    sizes.mean_extent = (1 / double(sizes.count)) * sum;
    return sizes;
  }

  MemoryMeter meter_;
  CellLists top_lists_, leaf_lists_;
  MeteredVector<std::uint32_t> subgrid_of_;  // by top cell
  MeteredVector<SubGrid> subgrids_;
  WalkSpace space_;
  CellGrid grid_;
  StructureStats stats_;
};

}  // namespace

// The defaults are near the best that was measured on teapot12 and gears4 (SPD) and a soup of 60,000
// triangles: a coarse top level, which costs few steps where nothing is, and sub-grids of the density of a
// good flat grid.
StructureKind two_level_grid_kind() {
  auto parameters = resolution_parameters("density 0.1");
  parameters.push_back({"threshold", ParameterType::integer, "8",
                        "a cell with more primitives than this gets a grid of its own", 0, 1e9});
  parameters.push_back({"leaf-density", ParameterType::number, "3",
                        "cells of that grid for each primitive of the cell", 1e-3, 1e3});
  parameters.push_back(fit_parameter());
  return {"two-level-grid",
          "a uniform grid whose crowded cells hold a grid of their own",
          "Jevans & Wyvill 1989; walk and lists as the grid's",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            Options options;
            options.top = resolution_rule(arguments, {ResolutionRule::Kind::density, 0.1});
            options.leaf = {ResolutionRule::Kind::density, arguments.number("leaf-density")};
            options.threshold = static_cast<std::uint64_t>(arguments.integer("threshold"));
            options.fit = fit_of(arguments);
            return std::make_unique<TwoLevelGrid>(input, options);
          }};
}

}  // namespace raymeter
