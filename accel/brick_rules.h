#pragma once
// What nodes of bricks are made of, and when they are split.
#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/brick_build.h"
#include "accel/brick_overlap.h"
#include "accel/bricks.h"
#include "accel/cell_overlap.h"
#include "accel/local_primitives.h"
#include "scenes/geometry/rounding.h"
#include "scenes/scene.h"

namespace raymeter {

using Corner = std::array<double, 3>;
struct Box {
  Corner low, high;
};

/// Of each cell how many primitives meet it; or where to put the next of them.
using CellCounts = std::array<std::uint32_t, 64>;
inline std::uint64_t sum_of(const CellCounts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint32_t n : counts) sum += n;
  return sum;
}

/// What nodes are made of, and how; safe to share between threads.
class NodeRules {
 public:
  NodeRules(const Scene& scene, const Bricks& bricks, const BrickOptions& options)
      : scene_(scene), bricks_(bricks), options_(options) {
    for (std::size_t a = 0; a < 3; ++a) blocks_[a] = (bricks.cells.n[a] + 3) / 4;
  }
  const Scene& scene() const { return scene_; }

  /// The grid in blocks of 4x4x4 cells, as bricks whose planes are the grid's but for their slack.
  std::uint64_t block_count() const { return cell_count(blocks_); }
  /// Calls visit(first, how many) for the rows of blocks that a primitive's box meets.
  template <class Visit>
  void for_each_row_near(std::uint32_t primitive, const Visit& visit) const {
    const CellRange cells = cells_of_box(bricks_.cells, scene_.bounds_of(primitive), bricks_.space.margin);
    const std::uint32_t first = cells.first[0] / 4, count = cells.last[0] / 4 - first + 1;
    for (std::uint32_t k = cells.first[2] / 4; k <= cells.last[2] / 4; ++k)
      for (std::uint32_t j = cells.first[1] / 4; j <= cells.last[1] / 4; ++j)
        visit(first + blocks_[0] * (j + std::uint64_t{blocks_[1]} * k), count);
  }
  CutBrick block(std::uint64_t index) const {
    const CellGrid& grid = bricks_.cells;
    CutBrick brick;
    brick.margin = 2 * bricks_.space.margin;
    const auto first = first_cell(index);
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      brick.layers[a] = static_cast<int>(std::min(4u, grid.n[a] - first[a]));
      brick.node.low[a] = rounded(grid.plane(axis, first[a]));
      brick.node.size[a] = std::max(rounded(grid.size[axis]), FLT_MIN);
      brick.margin += 0x1p-22 * (std::abs(grid.plane(axis, first[a])) + 4 * grid.size[axis]);  // for rounding
    }
    return brick;
  }
  /// The number of a block's cell in the grid, and its box, grown by the walk's margin.
  std::uint64_t root_cell(std::uint64_t block, unsigned cell) const {
    const auto at = cell_at(block, cell);
    return bricks_.cells.cell(at[0], at[1], at[2]);
  }
  Box root_box(std::uint64_t block, unsigned cell) const {
    const auto at = cell_at(block, cell);
    Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      box.low[a] = bricks_.cells.plane(axis, at[a]) - bricks_.space.margin;
      box.high[a] = bricks_.cells.plane(axis, at[a] + 1) + bricks_.space.margin;
    }
    return box;
  }

  RootBox root_box_of(std::uint64_t block, unsigned cell, const BrickNode& root) const {
    const auto at = cell_at(block, cell);
    RootBox box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double corner = bricks_.cells.plane(axis, at[a]), margin = bricks_.space.margin;
      box.set(axis, (root.plane(axis, 0) - margin - corner) * bricks_.cells.inverse_size[axis],
              (root.plane(axis, 4) + margin - corner) * bricks_.cells.inverse_size[axis]);
    }
    return box;
  }

  /// Triangles come before all others.
  template <class Primitives>
  std::size_t triangles_among(const Primitives& all, std::span<const std::uint32_t> some) const {
    const auto is_triangle = [&](std::uint32_t p) { return scene_.is_triangle(all.primitive(p)); };
    if (some.empty() || is_triangle(some.back())) return some.size();
    return static_cast<std::size_t>(std::ranges::partition_point(some, is_triangle) - some.begin());
  }

  template <class Triangles, class Others>
  Bounds bounds_of(const Triangles& triangles, const Others& others) const {
    Bounds bounds;
    triangles.for_each([&](const TriangleColumns& columns, std::size_t) {
      bounds.extend(options_.overlap->bounds_of(columns));
    });
    for (const std::uint32_t p : others) bounds.extend(scene_.bounds_of(p));
    return bounds;
  }

  /// The least box around what lies in a cell, cut into at most 4x4x4 cells: no axis into slices much thinner
  /// than the others.
  CutBrick cut(const Bounds& bounds, const Box& cell) const {
    const Box box = tight_box(bounds, cell);
    CutBrick brick;
    brick.margin = bricks_.margin;
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, box.high[a] - box.low[a]);
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(box.high[a] - box.low[a] > longest / 64)) brick.layers[a] = 1;
      brick.node.low[a] = float_below(box.low[a]);
      brick.node.size[a] = -float_below(-(box.high[a] - double(brick.node.low[a])) / brick.layers[a]);
    }
    return brick;
  }

  /// Which cells each primitive meets.
  template <class Triangles, class Others>
  void cells_of(const CutBrick& brick, const Triangles& triangles, const Others& others,
                std::span<std::uint64_t> cells) const {
    triangles.for_each([&](const TriangleColumns& columns, std::size_t first) {
      options_.overlap->cells_of(brick, columns, &cells[first]);
    });
    std::size_t i = cells.size() - others.size();
    for (const std::uint32_t p : others) cells[i++] = cells_of_other(brick, scene_, p);
  }
  void count(std::span<const std::uint64_t> cells, CellCounts& counts) const {
    options_.overlap->count_bits(cells, counts);
  }

  /// Whether to look at the cells of so many primitives at all.
  bool may_split(const CutBrick& brick, std::size_t primitives, std::uint32_t level) const {
    return primitives > (options_.leaf != 0 ? options_.leaf : block_size) && level < deepest_brick &&
           can_be_split(brick);
  }
  /// Whether children for its cells are worth making. `duplication`: references that a primitive has by the
  /// splits above.
  bool splits(const CutBrick& brick, const CellCounts& counts, std::size_t primitives,
              double duplication) const {
    const auto occupied = static_cast<std::size_t>(std::popcount(brick.node.occupied));
    const std::uint64_t references = sum_of(counts);
    const double more = double(references) / double(primitives);
    if (references == primitives * occupied) return false;  // every primitive meets every cell
    if (duplication * more > most_duplication) return false;
    if (options_.leaf != 0) return true;
    // A convex cell is pierced in proportion to its area.
    const auto& [x, y, z] = brick.node.size;
    const double wx = double(x) * brick.layers[0], wy = double(y) * brick.layers[1],
                 wz = double(z) * brick.layers[2];
    const double chance = (double(x) * y + double(y) * z + double(z) * x) / (wx * wy + wy * wz + wz * wx);
    std::size_t blocks = 0;
    for (const std::uint32_t n : counts) blocks += blocks_of(n);
    const double pierced = std::min(1.0, chance * double(occupied));
    return (node_cost + chance * cost_of_leaves(occupied, blocks, leaf_chance)) *
               (1 + duplication_cost * (more - 1)) <
           cost_of_leaves(1, blocks_of(primitives), pierced);
  }

 private:
  /// The expected cost, in cycles, of stepping through a node, of a leaf and of a block of triangles in it:
  /// the first two fitted on a prototype, the last on meshes.
  static constexpr double node_cost = 55, leaf_cost = 20, block_cost = 26;
  /// A block is as many triangles as the widest vector has lanes.
  static constexpr std::size_t block_size = widest_vector;
  /// How often a ray that meets a leaf's box goes on to its triangles: it must pierce an occupied cell.
  static constexpr double leaf_chance = 0.6;
  /// How much dearer a split is for each reference that it makes of one, for what leaves the cache.
  static constexpr double duplication_cost = 0.2;
  /// No primitive gets more references than this from splits that each seem worth it.
  static constexpr double most_duplication = 4;

  static std::size_t blocks_of(std::size_t primitives) { return (primitives + block_size - 1) / block_size; }
  /// Of so many leaves with so many blocks in all, each of which goes on to its triangles with that chance.
  static double cost_of_leaves(std::size_t leaves, std::size_t blocks, double chance) {
    return node_cost * double(leaves) + chance * (leaf_cost * double(leaves) + block_cost * double(blocks));
  }

  Resolution first_cell(std::uint64_t block) const {
    return {static_cast<std::uint32_t>(4 * (block % blocks_[0])),
            static_cast<std::uint32_t>(4 * (block / blocks_[0] % blocks_[1])),
            static_cast<std::uint32_t>(4 * (block / blocks_[0] / blocks_[1]))};
  }
  Resolution cell_at(std::uint64_t block, unsigned cell) const {
    const Resolution first = first_cell(block);
    return {first[0] + cell % 4, first[1] + cell / 4 % 4, first[2] + cell / 16};
  }

  /// Grown by a margin: see RayPacket.
  Box tight_box(const Bounds& bounds, const Box& cell) const {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double low = std::clamp<double>(bounds.low[axis], cell.low[a], cell.high[a]);
      const double high = std::clamp<double>(bounds.high[axis], cell.low[a], cell.high[a]);
      const double margin = bricks_.margin + 0x1p-20 * (high - low);
      box.low[a] = low - margin;
      box.high[a] = high + margin;
    }
    return box;
  }

  /// Whether floats can tell its planes apart.
  static bool can_be_split(const CutBrick& brick) {
    for (std::size_t a = 0; a < 3; ++a)
      if (brick.layers[a] > 1 &&
          !(brick.node.size[a] > 0x1p-21 * std::abs(brick.node.plane(static_cast<int>(a), 2))))
        return false;
    return true;
  }

  const Scene& scene_;
  const Bricks& bricks_;
  BrickOptions options_;
  Resolution blocks_{};
};

inline Box cell_of(const BrickNode& node, unsigned cell) {
  const std::array<int, 3> at{static_cast<int>(cell % 4), static_cast<int>(cell / 4 % 4),
                              static_cast<int>(cell / 16)};
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = node.plane(static_cast<int>(a), at[a]);
    box.high[a] = node.plane(static_cast<int>(a), at[a] + 1);
  }
  return box;
}

}  // namespace raymeter
