#include "accel/brick_grid.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "accel/brick_build.h"
#include "accel/brick_kernels.h"
#include "accel/cell_overlap.h"
#include "accel/isa.h"
#include "accel/parallel.h"

namespace raymeter {
namespace {

const BrickOverlap& overlap_for(std::string_view isa) {
  return *std::ranges::find(brick_overlaps(), isa, &BrickOverlap::isa);
}

/// Which part of the cells has a vertex in it, or the middle of a primitive that is no triangle.
double part_with_vertices(const Scene& scene, const CellGrid& grid, MemoryMeter& meter) {
  MeteredVector<std::uint8_t> marks(cell_count(grid.n), 0, MeteredAllocator<std::uint8_t>(meter));
  const auto mark = [&](double x, double y, double z) {
    std::atomic_ref(marks[grid.cell(grid.layer(0, x), grid.layer(1, y), grid.layer(2, z))])
        .store(1, std::memory_order_relaxed);
  };
  const auto vertices = scene.vertices();
  for_ranges(vertices.size(), 4096, [&](std::uint64_t begin, std::uint64_t end) {
    for (const Vec3& v : vertices.subspan(begin, end - begin)) mark(v.x, v.y, v.z);
  });
  for (auto p = static_cast<std::uint32_t>(scene.triangles().size()); p < scene.primitive_count(); ++p) {
    const Bounds box = scene.bounds_of(p);
    const auto middle = [&](int axis) { return 0.5 * (double(box.low[axis]) + box.high[axis]); };
    mark(middle(0), middle(1), middle(2));
  }
  return double(std::ranges::count(marks, 1)) / double(marks.size());
}

class BrickGrid final : public Structure {
 public:
  /// Without `top`, cells for each primitive by how much of the scene is full: 0.02, and of what was tried on
  /// meshes and scattered triangles the best where nearly all of it is, or nearly nothing.
  BrickGrid(const BuildInput& input, std::optional<ResolutionRule> top, std::uint32_t leaf,
            const BrickKernels& kernels, const std::string& query)
      : scene_(input.scene), kernels_(kernels), query_(query), meter_(input.memory_limit), bricks_(meter_) {
    bricks_.space = float_walk_space(scene_, "brick-grid");
    bricks_.margin = std::max(bricks_.space.margin * 0x1p-17, 0x1p-100);
    const ShapeSizes sizes = shape_sizes(scene_);
    const auto limits = ResolutionLimits::within(input.memory_limit, 32 * bricks_.space.margin);
    const auto of_density = [](double value) {
      return ResolutionRule{ResolutionRule::Kind::density, value, {1, 1, 1}};
    };
    if (!top) {
      const Resolution n = choose_resolution(of_density(0.02), sizes, limits).n;
      const double part =
          part_with_vertices(scene_, CellGrid(bricks_.space.low, bricks_.space.high, n), meter_);
      top = of_density(part > 0.9 ? 0.06 : part < 0.1 ? 0.004 : 0.02);
    }
    auto chosen = choose_resolution(*top, sizes, limits);
    // Coarser than other grids where primitives are large: a reference here is 40 bytes and no number.
    const auto limit = std::max<std::uint64_t>(std::uint64_t{1} << 22, 8 * scene_.primitive_count());
    bricks_.cells = registrable_grid(scene_, bricks_.space, limit, chosen);
    bricks_.grid = FloatGrid(bricks_.cells);
    build_bricks(scene_, {leaf, &overlap_for(kernels.isa)}, meter_, bricks_);

    stats_.isa = kernels.isa;
    stats_.note = chosen.note;
    stats_.resolution = chosen.n;
    stats_.empty_cells = static_cast<std::uint64_t>(std::ranges::count(bricks_.roots, Bricks::empty_cell));
    stats_.cells = stats_.empty_cells;
    for (const BrickNode& node : bricks_.nodes) {
      ++(node.is_leaf() ? stats_.cells : stats_.inner_nodes);
      if (node.is_leaf()) stats_.references += node.triangles + node.others;
    }
    stats_.depth = 1 + bricks_.depth;
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"roots", bricks_.roots.capacity() * (sizeof(std::uint32_t) + sizeof(RootBox))},
                            {"nodes", bricks_.nodes.bytes()},
                            {"leaves", bricks_.words.bytes()}};
  }

  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    kernels_.trace_closest(bricks_, scene_, batch, packets(batch), hits);
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    kernels_.trace_any(bricks_, scene_, batch, packets(batch), occluded);
  }
  void count_closest(const BatchView& batch, std::span<Hit> hits,
                     std::span<RayCounters> counters) const override {
    kernels_.count_closest(bricks_, scene_, batch, packets(batch), hits, counters);
  }
  void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                 std::span<RayCounters> counters) const override {
    kernels_.count_any(bricks_, scene_, batch, packets(batch), occluded, counters);
  }
  StructureStats stats() const override { return stats_; }

 private:
  PacketUse packets(const BatchView& batch) const {
    if (query_ == "auto") return batch.coherent ? PacketUse::where_worth_while : PacketUse::never;
    return query_ == "1" ? PacketUse::never : PacketUse::always;
  }

  const Scene& scene_;
  const BrickKernels& kernels_;
  std::string query_;
  MemoryMeter meter_;
  Bricks bricks_;
  StructureStats stats_;
};

}  // namespace

StructureKind brick_grid_kind() {
  auto parameters = resolution_parameters(
      "density 0.02; 0.06 where nine of ten cells have a vertex, 0.004 where not one of ten has");
  parameters.push_back({"leaf", ParameterType::integer, "0",
                        "split nodes of more primitives than this; 0: where it seems to pay", 0, 1e6});
  parameters.push_back(isa_parameter());
  parameters.push_back(
      {.name = "query",
       .type = ParameterType::choice,
       .default_value = "auto",
       .meaning = "rays traced together; auto: 16 of a coherent batch where that is worth while, else 1",
       .choices = {"auto", "1", "16"}});
  return {"brick-grid",
          "a coarse grid of trees of 4x4x4 bricks, walked and tested with SIMD instructions",
          "Jevans & Wyvill 1989; masks: Museth 2013; tests in blocks: Moeller & Trumbore 1997",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            // No rule that is given has the density 0.
            const ResolutionRule given =
                resolution_rule(arguments, {ResolutionRule::Kind::density, 0, {1, 1, 1}});
            return std::make_unique<BrickGrid>(
                input,
                given.kind == ResolutionRule::Kind::density && given.value == 0 ? std::nullopt
                                                                                : std::optional(given),
                static_cast<std::uint32_t>(arguments.integer("leaf")),
                kernels_for(arguments, brick_kernels()), arguments.text("query"));
          }};
}

}  // namespace raymeter
