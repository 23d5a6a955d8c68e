#include "accel/brick_grid.h"

#include <algorithm>

#include "accel/brick_build.h"
#include "accel/brick_kernels.h"
#include "accel/cell_overlap.h"
#include "scenes/base/error.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

const BrickOverlap& overlap_for(std::string_view isa) {
  return *std::ranges::find(brick_overlaps(), isa, &BrickOverlap::isa);
}

class BrickGrid final : public Structure {
 public:
  BrickGrid(const BuildInput& input, const ResolutionRule& top, std::uint32_t leaf,
            const BrickKernels& kernels)
      : scene_(input.scene), kernels_(kernels), meter_(input.memory_limit), bricks_(meter_) {
    const Bounds box = scene_.bounds();
    bricks_.space = WalkSpace(box.empty() ? Bounds{{0, 0, 0}, {0, 0, 0}} : box, 0x1p-17);
    for (int axis = 0; axis < 3; ++axis) bricks_.space.low[axis] = float_below(bricks_.space.low[axis]);
    bricks_.margin = std::max(bricks_.space.margin * 0x1p-17, 0x1p-100);
    for (int axis = 0; axis < 3; ++axis)
      if (std::max(-bricks_.space.low[axis], bricks_.space.high[axis]) > 0x1p126)
        throw Error("brick-grid: coordinates beyond 8.5e+37 would leave the range of floats");
    auto chosen = choose_resolution(top, shape_sizes(scene_),
                                    ResolutionLimits::within(input.memory_limit, 32 * bricks_.space.margin));
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
    stats_.bytes_by_part = {{"roots", bricks_.roots.capacity() * sizeof(std::uint32_t)},
                            {"nodes", bricks_.nodes.capacity() * sizeof(BrickNode)},
                            {"leaves", bricks_.words.capacity() * sizeof(std::uint32_t)}};
  }

  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    kernels_.trace_closest(bricks_, scene_, batch, hits);
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    kernels_.trace_any(bricks_, scene_, batch, occluded);
  }
  void count_closest(const BatchView& batch, std::span<Hit> hits,
                     std::span<RayCounters> counters) const override {
    kernels_.count_closest(bricks_, scene_, batch, hits, counters);
  }
  void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                 std::span<RayCounters> counters) const override {
    kernels_.count_any(bricks_, scene_, batch, occluded, counters);
  }
  StructureStats stats() const override { return stats_; }

 private:
  const Scene& scene_;
  const BrickKernels& kernels_;
  MemoryMeter meter_;
  Bricks bricks_;
  StructureStats stats_;
};

const BrickKernels& kernels_for(const std::string& isa) {
  const auto kernels = brick_kernels();
  if (kernels.empty()) throw Error("brick-grid needs an x86 CPU with SSE4.2");
  if (isa == "default") return *kernels.front();
  for (const BrickKernels* const k : kernels)
    if (k->isa == isa) return *k;
  throw Error("brick-grid: this CPU has no " + isa);
}

}  // namespace

StructureKind brick_grid_kind() {
  auto parameters = resolution_parameters("density 0.02");
  parameters.push_back({"leaf", ParameterType::integer, "0",
                        "split nodes of more primitives than this; 0: where it seems to pay", 0, 1e6});
  parameters.push_back({.name = "isa",
                        .type = ParameterType::choice,
                        .default_value = "default",
                        .meaning = "instruction set; default: the widest that the CPU has",
                        .choices = {"default", "sse4.2", "avx2", "avx512"}});
  return {"brick-grid",
          "a coarse grid of trees of 4x4x4 bricks, walked and tested with SIMD instructions",
          "Jevans & Wyvill 1989; masks: Museth 2013; tests in blocks: Moeller & Trumbore 1997",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            return std::make_unique<BrickGrid>(
                input, resolution_rule(arguments, {ResolutionRule::Kind::density, 0.02}),
                static_cast<std::uint32_t>(arguments.integer("leaf")), kernels_for(arguments.text("isa")));
          }};
}

}  // namespace raymeter
