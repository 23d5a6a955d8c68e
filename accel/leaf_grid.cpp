#include "accel/leaf_grid.h"

#include <fmt/format.h>

#include <algorithm>

#include "accel/isa.h"
#include "accel/parallel.h"
#include "accel/sparse_lists.h"
#include "accel/two_level_cells.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// Writes the leaf of each of so many cells that has primitives, lists(cell), or a sub-grid,
/// subgrid_of(cell).
template <class Lists, class SubGridOf>
void write_leaves(const Scene& scene, std::uint64_t cells, const Lists& lists, const SubGridOf& subgrid_of,
                  LeafGrid& grid) {
  const auto triangles_of = [&](std::span<const std::uint32_t> list) {
    // Lists ascend, and triangles come before all others.
    return static_cast<std::uint32_t>(
        std::ranges::lower_bound(list, static_cast<std::uint32_t>(scene.triangle_count())) - list.begin());
  };
  grid.leaves.assign(cells, LeafGrid::empty_cell);
  std::uint64_t total = 0;
  for (std::uint64_t c = 0; c < cells; ++c) {
    const std::span<const std::uint32_t> list = lists(c);
    if (list.empty() && subgrid_of(c) == TwoLevelCells::no_subgrid) continue;
    if (total >= LeafGrid::empty_cell)
      throw Error("the leaves' words are more than 32 bits can number; choose fewer cells");
    grid.leaves[c] = static_cast<std::uint32_t>(total);
    const std::uint32_t triangles = triangles_of(list);
    total += LeafGrid::header + LeafWords::count(triangles) + list.size() - triangles;
  }
  grid.words.resize(total + widest_vector);
  std::fill_n(grid.words.end() - widest_vector, widest_vector, 0u);
  for_ranges(cells, 1024, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c) {
      if (grid.leaves[c] == LeafGrid::empty_cell) continue;
      std::uint32_t* to = &grid.words[grid.leaves[c]];
      if (const std::uint32_t subgrid = subgrid_of(c); subgrid != TwoLevelCells::no_subgrid) {
        *to++ = LeafGrid::subgrid;
        *to = subgrid;
        continue;
      }
      const std::span<const std::uint32_t> list = lists(c);
      const std::uint32_t triangles = triangles_of(list);
      *to++ = triangles;
      *to++ = static_cast<std::uint32_t>(list.size()) - triangles;
      for (std::uint32_t i = 0; i < triangles; ++i)
        LeafWords::put(to, triangles, i, scene.triangle(list[i]), list[i]);
      to += TriangleRows::rows * triangles;
      to = std::fill_n(to, 2 * LeafWords::masks(triangles), 1u);  // all blocks lie in the leaf's only cell
      std::ranges::copy(list.subspan(triangles), to);
    }
  });
}

class LeafGridStructure final : public Structure {
 public:
  LeafGridStructure(const BuildInput& input, const std::string& name, const ResolutionRule& rule, Fit fit,
                    const LeafGridKernels& kernels)
      : LeafGridStructure(input, name, kernels) {
    auto chosen = choose_resolution(rule, shape_sizes(scene_), limits());
    {
      SparseLists lists(meter_);
      grid_.grid = FloatGrid(register_primitives(scene_, grid_.space, most_work(), fit, chosen, lists));
      write_leaves(
          scene_, lists.cells(), [&](std::uint64_t c) { return lists[c]; },
          [](std::uint64_t) { return TwoLevelCells::no_subgrid; }, grid_);
      stats_.empty_cells = lists.empty_cells();
      stats_.references = lists.references();
    }
    stats_.resolution = chosen.n;
    stats_.cells = grid_.leaves.size();
    stats_.note = chosen.note;
    set_bytes();
  }

  LeafGridStructure(const BuildInput& input, const std::string& name, TwoLevelOptions options,
                    const LeafGridKernels& kernels)
      : LeafGridStructure(input, name, kernels) {
    options.begin_at_floats = true;
    {
      const TwoLevelCells cells(scene_, grid_.space, limits(), most_work(), options, meter_);
      grid_.grid = FloatGrid(cells.grid());
      const std::uint64_t top = cells.top_lists().cells(), leaves = cells.leaf_lists().cells();
      if (top + leaves > std::uint64_t{1} << 31u)
        throw Error("more cells than 31 bits can number; choose fewer");
      grid_.subgrids.resize(cells.subgrids().size());
      for (std::size_t i = 0; i < grid_.subgrids.size(); ++i) {
        const SubGrid& sub = cells.subgrids()[i];
        LeafGrid::SubGrid& in_floats = grid_.subgrids[i] = {FloatGrid(sub.grid), top + sub.first_cell};
        // Where the walk is, and where primitives are registered, is as uncertain as in the upper grid.
        in_floats.grid.cell_reach += static_cast<float>(16 * grid_.space.margin);
      }
      write_leaves(
          scene_, top + leaves,
          [&](std::uint64_t c) { return c < top ? cells.top_lists()[c] : cells.leaf_lists()[c - top]; },
          [&](std::uint64_t c) { return c < top ? cells.subgrid_of(c) : TwoLevelCells::no_subgrid; }, grid_);
      stats_ = cells.stats();
    }
    set_bytes();
  }

  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    kernels_.trace_closest(grid_, scene_, batch, hits);
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    kernels_.trace_any(grid_, scene_, batch, occluded);
  }
  void count_closest(const BatchView& batch, std::span<Hit> hits,
                     std::span<RayCounters> counters) const override {
    kernels_.count_closest(grid_, scene_, batch, hits, counters);
  }
  void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                 std::span<RayCounters> counters) const override {
    kernels_.count_any(grid_, scene_, batch, occluded, counters);
  }
  StructureStats stats() const override { return stats_; }

 private:
  LeafGridStructure(const BuildInput& input, const std::string& name, const LeafGridKernels& kernels)
      : scene_(input.scene), kernels_(kernels), meter_(input.memory_limit), grid_(meter_) {
    grid_.space = float_walk_space(scene_, name);
  }
  /// A cell is numbered twice while building.
  ResolutionLimits limits() const {
    return ResolutionLimits::within(meter_.limit() / 2, 32 * grid_.space.margin);
  }
  /// Coarser than grids of indices where primitives are large: a reference here is 48 bytes while building.
  std::uint64_t most_work() const {
    return std::max<std::uint64_t>(std::uint64_t{1} << 22, 32 * scene_.primitive_count());
  }
  void set_bytes() {
    stats_.isa = kernels_.isa;
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"cells", grid_.leaves.capacity() * sizeof(std::uint32_t)},
                            {"leaves", grid_.words.capacity() * sizeof(std::uint32_t)}};
    if (!grid_.subgrids.empty())
      stats_.bytes_by_part.push_back({"sub-grids", grid_.subgrids.capacity() * sizeof(LeafGrid::SubGrid)});
  }

  const Scene& scene_;
  const LeafGridKernels& kernels_;
  MemoryMeter meter_;
  LeafGrid grid_;
  StructureStats stats_;
};

}  // namespace

std::vector<Parameter> leaf_parameters() {
  return {{.name = "leaf",
           .type = ParameterType::choice,
           .default_value = "scalar",
           .meaning = "test a cell's triangles one by one (scalar) or 4, 8 or 16 at a time (simd)",
           .choices = {"scalar", "simd"}},
          isa_parameter()};
}

namespace {

/// As what is chosen says.
template <class... How>
std::unique_ptr<Structure> build_chosen(const Arguments& arguments, const BuildInput& input,
                                        const How&... how) {
  if (arguments.text("leaf") == "simd")
    return std::make_unique<LeafGridStructure>(input, arguments.name(), how...,
                                               kernels_for(arguments, leaf_grid_kernels()));
  if (arguments.text("isa") != "default")
    throw Error(fmt::format("{}: isa={} goes with leaf=simd only", arguments.name(), arguments.text("isa")));
  return nullptr;
}

}  // namespace

std::unique_ptr<Structure> build_leaf_grid(const Arguments& arguments, const BuildInput& input,
                                           const ResolutionRule& rule, Fit fit) {
  return build_chosen(arguments, input, rule, fit);
}
std::unique_ptr<Structure> build_leaf_grid(const Arguments& arguments, const BuildInput& input,
                                           const TwoLevelOptions& options) {
  return build_chosen(arguments, input, options);
}

}  // namespace raymeter
