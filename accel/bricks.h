#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>

#include "accel/cell_grid.h"
#include "accel/growing_array.h"
#include "accel/memory_meter.h"
#include "accel/triangle_rows.h"
#include "accel/walk_space.h"
#include "scenes/scene.h"

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

/// A leaf's words: its triangles in blocks, each of them rows of its own; where there is more than one, for
/// each the cells that its triangles meet, 64 bits in two words; then the indices of the others.
struct LeafWords {
  static constexpr std::size_t block = 16;  ///< triangles, or fewer in the last one
  static bool has_masks(std::size_t triangles) { return triangles > block; }
  static std::size_t masks(std::size_t triangles) {
    return has_masks(triangles) ? (triangles + block - 1) / block : 0;
  }
  /// Where a leaf of bricks may begin, from `word` on: whole blocks begin with a line of the cache.
  static std::uint64_t begin(std::uint64_t word, std::size_t triangles) {
    constexpr std::size_t line = cache_line / sizeof(std::uint32_t);
    return triangles < block ? word : (word + line - 1) / line * line;
  }
  /// Without the others.
  static std::size_t count(std::size_t triangles) {
    return TriangleRows::rows * triangles + 2 * masks(triangles);
  }
  /// The block of triangles that begins with `first`.
  static TriangleRows rows(const std::uint32_t* words, std::size_t triangles, std::size_t first) {
    return {words + TriangleRows::rows * first,
            static_cast<std::uint32_t>(std::min(block, triangles - first))};
  }
  /// Writes the i-th of the triangles.
  static void put(std::uint32_t* words, std::size_t triangles, std::size_t i, const Triangle& triangle,
                  std::uint32_t primitive) {
    const std::size_t first = i / block * block;
    TriangleRows::put(words + TriangleRows::rows * first, std::min(block, triangles - first), i - first,
                      triangle, primitive);
  }
  /// The cells that the block of triangles that begins with `first` meets, or all.
  static std::uint64_t cells(const std::uint32_t* words, std::size_t triangles, std::size_t first) {
    if (!has_masks(triangles)) return ~std::uint64_t{0};
    const std::uint32_t* const mask = words + TriangleRows::rows * triangles + 2 * (first / block);
    return mask[0] | std::uint64_t{mask[1]} << 32u;
  }
};
/// The most floats that a kernel reads at once: so many words follow the last leaf.
inline constexpr std::size_t widest_vector = 16;

/// The box of a root, grown by what a walk may be off, in parts of its cell: in five bits each, for x, y and
/// z, where it begins, less than one part before the cell at most, and where it ends.
struct RootBox {
  static constexpr int parts = 28;  ///< of a cell
  std::uint32_t bits = 0;

  /// `low` and `high`: in cells, from the cell's corner.
  void set(int axis, double low, double high) {
    const auto part = [](double x) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(x * parts), -1.0, double(parts)) + 1);
    };
    bits |= part(low) << (10 * axis) | part(high) << (10 * axis + 5);
  }
};

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

/// The space of a scene that BrickWalk goes through: grown by the margin that it needs, and begun at a float
/// on each axis. Throws Error, naming the structure, where coordinates would leave the range of floats.
WalkSpace float_walk_space(const Scene& scene, const std::string& structure);

/// A uniform grid whose occupied cells each hold a tree of bricks.
struct Bricks {
  static constexpr std::uint32_t empty_cell = 0xffffffffu;

  explicit Bricks(MemoryMeter& meter)
      : roots(MeteredAllocator<std::uint32_t>(meter)),
        root_boxes(MeteredAllocator<RootBox>(meter)),
        nodes(meter),
        words(meter) {}

  WalkSpace space;
  CellGrid cells;
  FloatGrid grid;                      ///< the same
  MeteredVector<std::uint32_t> roots;  ///< by cell: its root among the nodes, or empty_cell
  MeteredVector<RootBox> root_boxes;   ///< by cell, of those that have one
  GrowingArray<BrickNode> nodes;
  GrowingArray<std::uint32_t> words;
  double margin = 0;        ///< what nodes' boxes and cells are grown by, at least
  std::uint32_t depth = 0;  ///< levels of bricks below a root, at most
};

/// Levels of bricks, at most: more than floats can tell apart.
inline constexpr std::uint32_t deepest_brick = 12;

}  // namespace raymeter
