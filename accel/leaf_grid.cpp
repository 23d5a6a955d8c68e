#include "accel/leaf_grid.h"

#include <fmt/format.h>

#include <algorithm>

#include "accel/cell_lists.h"
#include "accel/isa.h"
#include "accel/parallel.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// Writes the leaf of each cell that has primitives.
void write_leaves(const Scene& scene, const CellLists& lists, LeafGrid& grid) {
  const auto triangles_of = [&](std::span<const std::uint32_t> list) {
    // Lists ascend, and triangles come before all others.
    return static_cast<std::uint32_t>(
        std::ranges::lower_bound(list, static_cast<std::uint32_t>(scene.triangle_count())) - list.begin());
  };
  grid.leaves.assign(lists.cells(), LeafGrid::empty_cell);
  std::uint64_t total = 0;
  for (std::uint64_t c = 0; c < lists.cells(); ++c) {
    const auto list = lists[c];
    if (list.empty()) continue;
    if (total >= LeafGrid::empty_cell)
      throw Error("the leaves' words are more than 32 bits can number; choose fewer cells");
    grid.leaves[c] = static_cast<std::uint32_t>(total);
    const std::uint32_t triangles = triangles_of(list);
    total += LeafGrid::header + LeafWords::count(triangles) + list.size() - triangles;
  }
  grid.words.resize(total + widest_vector);
  std::fill_n(grid.words.end() - widest_vector, widest_vector, 0u);
  for_ranges(lists.cells(), 1024, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c) {
      const auto list = lists[c];
      if (list.empty()) continue;
      const std::uint32_t triangles = triangles_of(list);
      std::uint32_t* to = &grid.words[grid.leaves[c]];
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
      : scene_(input.scene), kernels_(kernels), meter_(input.memory_limit), grid_(meter_) {
    grid_.space = float_walk_space(scene_, name);
    const double margin = grid_.space.margin;
    // A cell is numbered twice while building.
    const auto limits = ResolutionLimits::within(input.memory_limit / 2, 32 * margin);
    auto chosen = choose_resolution(rule, shape_sizes(scene_), limits);
    // Coarser than grids of indices where primitives are large: a reference here is 48 bytes while building.
    const auto limit = std::max<std::uint64_t>(std::uint64_t{1} << 22, 32 * scene_.primitive_count());
    const CellGrid cells = registrable_grid(scene_, grid_.space, limit, chosen);
    grid_.grid = FloatGrid(cells);
    {
      CellLists lists(meter_);
      lists.build(cell_count(chosen.n), scene_.primitive_count(), [&](std::uint32_t p, const auto& add) {
        for_each_cell_of(scene_, p, cells, margin, fit, add);
      });
      write_leaves(scene_, lists, grid_);
      stats_.empty_cells = lists.empty_cells();
      stats_.references = lists.references();
    }
    stats_.isa = kernels.isa;
    stats_.resolution = chosen.n;
    stats_.cells = grid_.leaves.size();
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"cells", grid_.leaves.capacity() * sizeof(std::uint32_t)},
                            {"leaves", grid_.words.capacity() * sizeof(std::uint32_t)}};
    stats_.note = chosen.note;
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

std::unique_ptr<Structure> build_leaf_grid(const Arguments& arguments, const BuildInput& input,
                                           const ResolutionRule& rule, Fit fit) {
  if (arguments.text("leaf") == "simd")
    return std::make_unique<LeafGridStructure>(input, arguments.name(), rule, fit,
                                               kernels_for(arguments, leaf_grid_kernels()));
  if (arguments.text("isa") != "default")
    throw Error(fmt::format("{}: isa={} goes with leaf=simd only", arguments.name(), arguments.text("isa")));
  return nullptr;
}

}  // namespace raymeter
