#include "accel/brick_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "accel/parallel.h"
#include "scenes/base/error.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// The expected cost, in cycles, of stepping through a node, of a leaf and of a block of triangles in it:
/// fitted on a prototype.
constexpr double node_cost = 55, leaf_cost = 20, block_cost = 34;
/// A block is as many triangles as the widest vector has lanes.
constexpr double block_size = widest_vector;
/// How often a ray that meets a leaf's box goes on to its triangles: it must pierce an occupied cell.
constexpr double leaf_chance = 0.6;
/// How much dearer a split is for each reference that it makes of one, for what leaves the cache.
constexpr double duplication_cost = 0.2;
/// No primitive gets more references than this from splits that each seem worth it.
constexpr double most_duplication = 8;

double cost_of_leaf(std::size_t primitives, double chance) {
  return node_cost + chance * (leaf_cost + block_cost * std::ceil(double(primitives) / block_size));
}

using Corner = std::array<double, 3>;
struct Box {
  Corner low, high;
};

class TreeBuilder {
 public:
  TreeBuilder(const Scene& scene, const Bricks& bricks, const BrickOptions& options, MemoryMeter& meter)
      : nodes(MeteredAllocator<BrickNode>(meter)),
        words(MeteredAllocator<std::uint32_t>(meter)),
        scene_(scene),
        margin_(bricks.margin),
        options_(options),
        stack_(MeteredAllocator<std::uint32_t>(meter)),
        masks_(MeteredAllocator<std::uint64_t>(meter)) {}

  /// A tree whose root is the next node.
  void add_tree(std::span<const std::uint32_t> primitives, const Box& cell) {
    const std::size_t root = nodes.size();
    nodes.emplace_back();
    stack_.assign(primitives.begin(), primitives.end());
    build(root, 0, cell, 0, 1);
  }

  MeteredVector<BrickNode> nodes;
  MeteredVector<std::uint32_t> words;
  std::uint32_t depth = 0;

 private:
  /// Makes node `index` of the primitives that lie in stack_ from `first` on, and in `cell`; takes them off.
  void build(std::size_t index, std::size_t first, const Box& cell, std::uint32_t level, double duplication) {
    const std::size_t count = stack_.size() - first;
    depth = std::max(depth, level);

    // The least box around what lies in the cell, cut into at most 4x4x4 cells: no axis into slices much
    // thinner than the others.
    const Box box = tight_box(std::span(stack_).subspan(first), cell);
    BrickNode node;
    std::array<int, 3> layers{4, 4, 4};
    double longest = 0;
    for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, box.high[a] - box.low[a]);
    for (std::size_t a = 0; a < 3; ++a) {
      const double extent = box.high[a] - box.low[a];
      if (!(extent > longest / 64)) layers[a] = 1;
      node.low[a] = float_below(box.low[a]);
      node.size[a] = -float_below(-(box.high[a] - double(node.low[a])) / layers[a]);
    }

    // Which cells each primitive meets.
    const BrickOverlap overlap(node, layers, margin_, options_.sums_within);
    const std::size_t first_mask = masks_.size();
    std::array<std::uint32_t, 64> counts{};
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t cells = overlap.cells_of(scene_, stack_[first + i]);
      masks_.push_back(cells);
      node.occupied |= cells;
      for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1)
        ++counts[static_cast<unsigned>(std::countr_zero(rest))];
    }

    const double more = split_duplication(count, counts);
    const bool separates = more < std::popcount(node.occupied);  // not every primitive meets every cell
    if (!separates || level == deepest_brick || duplication * more > most_duplication ||
        !worth_splitting(node, layers, counts, count, more) || !can_be_split(node, layers)) {
      make_leaf(node, std::span(stack_).subspan(first));
      nodes[index] = node;
    } else {
      const std::size_t base = nodes.size();
      node.base = static_cast<std::uint32_t>(base);
      nodes[index] = node;
      nodes.resize(base + static_cast<std::size_t>(std::popcount(node.occupied)));
      const std::size_t end = first + count;
      for (std::uint64_t rest = node.occupied; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<unsigned>(std::countr_zero(rest));
        for (std::size_t i = 0; i < count; ++i)
          if (masks_[first_mask + i] >> bit & 1u) stack_.push_back(stack_[first + i]);
        build(node.child(bit), end, cell_of(node, bit), level + 1, duplication * more);
      }
    }
    masks_.resize(first_mask);
    stack_.resize(first);
  }

  /// Grown by a margin: see BrickRay.
  Box tight_box(std::span<const std::uint32_t> primitives, const Box& cell) const {
    Box box{cell.high, cell.low};
    for (const std::uint32_t p : primitives) {
      const Bounds bounds = scene_.bounds_of(p);
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        box.low[a] = std::min(box.low[a], std::clamp<double>(bounds.low[axis], cell.low[a], cell.high[a]));
        box.high[a] = std::max(box.high[a], std::clamp<double>(bounds.high[axis], cell.low[a], cell.high[a]));
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const double margin = margin_ + 0x1p-20 * (box.high[a] - box.low[a]);
      box.low[a] -= margin;
      box.high[a] += margin;
    }
    return box;
  }

  static Box cell_of(const BrickNode& node, unsigned cell) {
    const std::array<int, 3> at{static_cast<int>(cell % 4), static_cast<int>(cell / 4 % 4),
                                static_cast<int>(cell / 16)};
    Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = node.plane(static_cast<int>(a), at[a]);
      box.high[a] = node.plane(static_cast<int>(a), at[a] + 1);
    }
    return box;
  }

  static double split_duplication(std::size_t count, const std::array<std::uint32_t, 64>& counts) {
    std::uint64_t references = 0;
    for (const std::uint32_t n : counts) references += n;
    return double(references) / double(std::max<std::size_t>(count, 1));
  }

  bool worth_splitting(const BrickNode& node, const std::array<int, 3>& layers,
                       const std::array<std::uint32_t, 64>& counts, std::size_t count, double duplication) {
    if (options_.leaf != 0) return count > options_.leaf;
    if (double(count) <= block_size) return false;
    // A convex cell is pierced in proportion to its area.
    const double x = node.size[0], y = node.size[1], z = node.size[2];
    const double cell_area = x * y + y * z + z * x;
    const double wx = x * layers[0], wy = y * layers[1], wz = z * layers[2];
    const double chance = cell_area / (wx * wy + wy * wz + wz * wx);
    double cost = 0;
    for (const std::uint32_t n : counts)
      if (n != 0) cost += chance * cost_of_leaf(n, leaf_chance);
    const double pierced = std::min(1.0, chance * std::popcount(node.occupied));
    return (node_cost + cost) * (1 + duplication_cost * (duplication - 1)) < cost_of_leaf(count, pierced);
  }

  /// Whether floats can tell its planes apart.
  static bool can_be_split(const BrickNode& node, const std::array<int, 3>& layers) {
    for (std::size_t a = 0; a < 3; ++a)
      if (layers[a] > 1 && !(node.size[a] > 0x1p-18 * std::abs(node.plane(static_cast<int>(a), 2))))
        return false;
    return true;
  }

  void make_leaf(BrickNode& leaf, std::span<const std::uint32_t> primitives) {
    const std::size_t place = words.size();
    if (place + (TriangleRows::rows + 1) * primitives.size() > std::numeric_limits<std::uint32_t>::max())
      throw Error("brick-grid: more than 16 GiB of leaves");
    const auto triangles = static_cast<std::size_t>(
        std::ranges::count_if(primitives, [&](std::uint32_t p) { return scene_.is_triangle(p); }));
    words.resize(place + TriangleRows::rows * triangles + (primitives.size() - triangles));
    leaf.base = static_cast<std::uint32_t>(place);
    leaf.triangles = static_cast<std::uint32_t>(triangles);
    leaf.others = static_cast<std::uint32_t>(primitives.size() - triangles);
    std::uint32_t column = 0;
    std::size_t other = place + TriangleRows::rows * triangles;
    for (const std::uint32_t p : primitives) {
      if (!scene_.is_triangle(p)) {
        words[other++] = p;
        continue;
      }
      TriangleRows::put(&words[place], leaf.triangles, column, scene_.triangle(p), p);
      ++column;
    }
  }

  const Scene& scene_;
  double margin_;
  BrickOptions options_;
  MeteredVector<std::uint32_t> stack_;
  MeteredVector<std::uint64_t> masks_;
};

}  // namespace

void build_bricks(const Scene& scene, const CellLists& lists, const BrickOptions& options, MemoryMeter& meter,
                  Bricks& bricks) {
  bricks.roots.assign(lists.cells(), Bricks::empty_cell);
  // Pieces of the grid with about as many references each, whatever the number of threads.
  constexpr std::uint64_t piece_size = 4096;
  std::vector<std::uint64_t> begins{0};
  for (std::uint64_t cell = 0, references = 0; cell < lists.cells(); ++cell) {
    references += lists[cell].size();
    if (references >= piece_size) {
      begins.push_back(cell + 1);
      references = 0;
    }
  }
  if (begins.back() != lists.cells()) begins.push_back(lists.cells());
  const std::size_t pieces = begins.size() - 1;

  std::vector<TreeBuilder> built;
  for (std::size_t i = 0; i < pieces; ++i) built.emplace_back(scene, bricks, options, meter);
  for_ranges(pieces, 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t piece = begin; piece < end; ++piece)
      for (std::uint64_t cell = begins[piece]; cell < begins[piece + 1]; ++cell) {
        if (lists[cell].empty()) continue;
        bricks.roots[cell] = static_cast<std::uint32_t>(built[piece].nodes.size());
        const auto& n = bricks.cells.n;
        const std::array<std::uint64_t, 3> at{cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]};
        Box box;
        for (int axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<std::size_t>(axis);
          box.low[a] = bricks.cells.plane(axis, double(at[a])) - bricks.space.margin;
          box.high[a] = bricks.cells.plane(axis, double(at[a]) + 1) + bricks.space.margin;
        }
        built[piece].add_tree(lists[cell], box);
      }
  });

  // One after the other.
  std::uint64_t nodes = 0, words = widest_vector;
  for (const TreeBuilder& tree : built) {
    nodes += tree.nodes.size();
    words += tree.words.size();
    bricks.depth = std::max(bricks.depth, tree.depth);
  }
  if (std::max(nodes, words) >= std::numeric_limits<std::uint32_t>::max())
    throw Error("brick-grid: more than 16 GiB of leaves");
  bricks.nodes.resize(nodes);
  bricks.words.resize(words);
  std::uint32_t first_node = 0, first_word = 0;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    TreeBuilder& tree = built[piece];
    for (std::uint64_t cell = begins[piece]; cell < begins[piece + 1]; ++cell)
      if (bricks.roots[cell] != Bricks::empty_cell) bricks.roots[cell] += first_node;
    for (BrickNode& node : tree.nodes) node.base += node.is_leaf() ? first_word : first_node;
    std::ranges::copy(tree.nodes, bricks.nodes.begin() + first_node);
    std::ranges::copy(tree.words, bricks.words.begin() + first_word);
    first_node += static_cast<std::uint32_t>(tree.nodes.size());
    first_word += static_cast<std::uint32_t>(tree.words.size());
    MeteredVector<BrickNode>(tree.nodes.get_allocator()).swap(tree.nodes);
    MeteredVector<std::uint32_t>(tree.words.get_allocator()).swap(tree.words);
  }
}

}  // namespace raymeter
