#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/bricks.h"
#include "accel/cell_grid.h"
#include "accel/cell_overlap.h"
#include "accel/grid_resolution.h"
#include "accel/memory_meter.h"
#include "accel/registry.h"
#include "accel/structure.h"
#include "accel/walk_space.h"

namespace raymeter {

/// A uniform grid whose triangles lie in the cells themselves, in rows, to be tested many at a time.
struct LeafGrid {
  static constexpr std::uint32_t empty_cell = 0xffffffffu;
  /// A cell's words: how many triangles and how many others there are; then those of a leaf (LeafWords) of
  /// one cell.
  static constexpr std::size_t header = 2;

  explicit LeafGrid(MemoryMeter& meter)
      : leaves(MeteredAllocator<std::uint32_t>(meter)), words(RawMeteredAllocator<std::uint32_t>(meter)) {}

  WalkSpace space;
  FloatGrid grid;
  MeteredVector<std::uint32_t> leaves;  ///< by cell: its first word, or empty_cell
  RawMeteredVector<std::uint32_t> words;
};

/// What is compiled once for each instruction set, and chosen when a structure is built.
struct LeafGridKernels {
  const char* isa;
  void (*trace_closest)(const LeafGrid&, const Scene&, const BatchView&, std::span<Hit>);
  void (*trace_any)(const LeafGrid&, const Scene&, const BatchView&, std::span<std::uint8_t>);
  void (*count_closest)(const LeafGrid&, const Scene&, const BatchView&, std::span<Hit>,
                        std::span<RayCounters>);
  void (*count_any)(const LeafGrid&, const Scene&, const BatchView&, std::span<std::uint8_t>,
                    std::span<RayCounters>);
};

/// Those that this CPU can run, the widest first.
std::vector<const LeafGridKernels*> leaf_grid_kernels();

/// The parameters `leaf` (scalar, simd) and `isa` of grids.
std::vector<Parameter> leaf_parameters();
/// The grid with SIMD leaves, where `leaf=simd` asks for it; else null. Throws Error for `isa` without it.
std::unique_ptr<Structure> build_leaf_grid(const Arguments& arguments, const BuildInput& input,
                                           const ResolutionRule& rule, Fit fit);

}  // namespace raymeter
