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

struct TwoLevelOptions;

/// A uniform grid whose triangles lie in the cells themselves, in rows, to be tested many at a time. Cells
/// may have grids of their own, whose cells then have the triangles.
struct LeafGrid {
  static constexpr std::uint32_t empty_cell = 0xffffffffu;
  /// A cell's words: how many triangles and how many others there are; then those of a leaf (LeafWords) of
  /// one cell. Or `subgrid`, and its index.
  static constexpr std::size_t header = 2;
  static constexpr std::uint32_t subgrid = 0xffffffffu;

  struct SubGrid {
    FloatGrid grid;
    std::uint64_t first_cell = 0;  ///< in `leaves`
  };

  explicit LeafGrid(MemoryMeter& meter)
      : leaves(MeteredAllocator<std::uint32_t>(meter)),
        words(RawMeteredAllocator<std::uint32_t>(meter)),
        subgrids(MeteredAllocator<SubGrid>(meter)) {}

  WalkSpace space;
  FloatGrid grid;
  /// By cell, the sub-grids' after the grid's: its first word, or empty_cell.
  MeteredVector<std::uint32_t> leaves;
  RawMeteredVector<std::uint32_t> words;
  MeteredVector<SubGrid> subgrids;
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
/// The same of two levels.
std::unique_ptr<Structure> build_leaf_grid(const Arguments& arguments, const BuildInput& input,
                                           const TwoLevelOptions& options);

}  // namespace raymeter
