#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "accel/cell_grid.h"
#include "accel/memory_meter.h"
#include "accel/triangle_rows.h"
#include "accel/walk_space.h"

namespace raymeter {

/// A box cut into 4x4x4 cells, of which a mask says which are occupied.
///
/// Occupancy masks over 64 children: Museth, "VDB: High-Resolution Sparse Volumes with Dynamic Topology",
/// 2013, and Laine & Karras, "Efficient Sparse Voxel Octrees", 2010; the tight box of a node is that of
/// bounding volume hierarchies.
struct alignas(64) BrickNode {
  static constexpr std::uint32_t inner = 0xffffffffu;

  std::array<float, 3> low{};
  /// Of an inner node, index of its first child, of which there is one for each occupied cell, in their order
  /// (x fastest). Of a leaf, place of its first word in Bricks::words.
  std::uint32_t base = 0;
  std::array<float, 3> size{};      ///< of a cell; an axis that is not cut has its only cell first
  std::uint32_t triangles = inner;  ///< of a leaf: how many
  std::uint64_t occupied = 0;       ///< bit x + 4 y + 16 z
  std::uint32_t others = 0;         ///< of a leaf: primitives that are not triangles

  bool is_leaf() const { return triangles != inner; }
  /// Index of the child in an occupied cell.
  std::uint32_t child(unsigned cell) const {
    return base + static_cast<std::uint32_t>(std::popcount(occupied & ((std::uint64_t{1} << cell) - 1)));
  }
  /// Where the planes between the cells are, i = 0..4.
  double plane(int axis, int i) const {
    const auto a = static_cast<std::size_t>(axis);
    return double(low[a]) + i * double(size[a]);
  }
};
static_assert(sizeof(BrickNode) == 64);

/// A leaf's words: the rows of its triangles, then the indices of the others.
/// The most floats that a kernel reads at once: so many words follow the last leaf.
inline constexpr std::size_t widest_vector = 16;

/// A grid in floats, as BrickWalk needs it.
struct FloatGrid {
  std::array<float, 3> low{}, size{}, inverse_size{}, layers{};
  /// Where rays may start: within four diagonals of the box; nowhere, where products of lengths would leave
  /// the range of floats.
  std::array<float, 3> nearby_low{}, nearby_high{};
  std::array<std::int32_t, 3> stride{};  ///< from layer to layer, in cells
  float cell_reach = 0;                  ///< 1-norm from one corner of a cell to the other, with some margin

  FloatGrid() = default;
  /// `grid` begins at a float on each axis.
  explicit FloatGrid(const CellGrid& grid);
};

/// A uniform grid whose occupied cells each hold a tree of bricks.
struct Bricks {
  static constexpr std::uint32_t empty_cell = 0xffffffffu;

  explicit Bricks(MemoryMeter& meter)
      : roots(MeteredAllocator<std::uint32_t>(meter)),
        nodes(MeteredAllocator<BrickNode>(meter)),
        words(RawMeteredAllocator<std::uint32_t>(meter)) {}

  WalkSpace space;
  CellGrid cells;
  FloatGrid grid;                      ///< the same
  MeteredVector<std::uint32_t> roots;  ///< by cell: its root among the nodes, or empty_cell
  MeteredVector<BrickNode> nodes;
  RawMeteredVector<std::uint32_t> words;
  double margin = 0;        ///< what nodes' boxes and cells are grown by, at least
  std::uint32_t depth = 0;  ///< levels of bricks below a root, at most
};

/// Levels of bricks, at most: more than floats can tell apart.
inline constexpr std::uint32_t deepest_brick = 12;

}  // namespace raymeter
