#include "accel/brick_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <ranges>
#include <utility>
#include <vector>

#include "accel/cell_overlap.h"
#include "accel/local_primitives.h"
#include "accel/parallel.h"
#include "accel/sparse_lists.h"
#include "scenes/base/error.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// The expected cost, in cycles, of stepping through a node, of a leaf and of a block of triangles in it:
/// the first two fitted on a prototype, the last on meshes.
constexpr double node_cost = 55, leaf_cost = 20, block_cost = 26;
/// A block is as many triangles as the widest vector has lanes.
constexpr std::size_t block_size = widest_vector;
/// How often a ray that meets a leaf's box goes on to its triangles: it must pierce an occupied cell.
constexpr double leaf_chance = 0.6;
/// How much dearer a split is for each reference that it makes of one, for what leaves the cache.
constexpr double duplication_cost = 0.2;
/// No primitive gets more references than this from splits that each seem worth it.
constexpr double most_duplication = 4;

std::size_t blocks_of(std::size_t primitives) {
  return (primitives + block_size - 1) / block_size;
}

/// Of so many leaves with so many blocks in all, each of which goes on to its triangles with that chance.
double cost_of_leaves(std::size_t leaves, std::size_t blocks, double chance) {
  return node_cost * double(leaves) + chance * (leaf_cost * double(leaves) + block_cost * double(blocks));
}

/// A node of more primitives is made by all threads together; what is smaller goes to a thread in parts of
/// about so many primitives.
constexpr std::size_t large_node = 16384, part_size = 4096;
/// A scene's triangles and vertices of more bytes are far, where one has to wait for them: on a mesh of so
/// many, fetching each only once begins to pay.
constexpr std::size_t far_bytes = 4 << 20;

using Corner = std::array<double, 3>;
struct Box {
  Corner low, high;
};

/// Of each cell how many primitives meet it; or where to put the next of them.
using CellCounts = std::array<std::uint32_t, 64>;
std::uint64_t sum_of(const CellCounts& counts) {
  std::uint64_t sum = 0;
  for (const std::uint32_t n : counts) sum += n;
  return sum;
}

/// A node to be made of the primitives in its cell; or, of the primitives near a block of 4x4x4 cells of the
/// grid, a stand-in for a node whose children are the roots there.
struct Task {
  std::span<const std::uint32_t> primitives;
  std::optional<std::uint32_t> block;
  std::uint32_t place = 0;  ///< of the node among the upper ones
  std::uint32_t level = 0;
  double duplication = 1;  ///< references to a primitive, by the splits above
  Box cell{};
  BrickNode made{};

  bool is_large() const { return primitives.size() > large_node; }
};

/// Where something begins among nodes and words.
struct Place {
  std::uint64_t node = 0, word = 0;
};

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

Box cell_of(const BrickNode& node, unsigned cell) {
  const std::array<int, 3> at{static_cast<int>(cell % 4), static_cast<int>(cell / 4 % 4),
                              static_cast<int>(cell / 16)};
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = node.plane(static_cast<int>(a), at[a]);
    box.high[a] = node.plane(static_cast<int>(a), at[a] + 1);
  }
  return box;
}

/// Puts each primitive where `places` says for each of its cells, and moves these on.
void distribute(std::span<const std::uint32_t> primitives, std::span<const std::uint64_t> cells,
                CellCounts& places, std::uint32_t* lists) {
  for (std::size_t i = 0; i < primitives.size(); ++i)
    for (std::uint64_t rest = cells[i]; rest != 0; rest &= rest - 1)
      lists[places[static_cast<unsigned>(std::countr_zero(rest))]++] = primitives[i];
}

/// Nodes and words that 32 bits can number.
constexpr std::uint64_t most_numbered = std::numeric_limits<std::uint32_t>::max();
[[noreturn]] void refuse() {
  throw Error("brick-grid: more than 16 GiB of leaves");
}

/// Nodes and leaves, with places of their own. Of leaves first only what is in them: their words are written
/// when it is known how many there are before them. Threads make neighbouring parts at the same time: none
/// shares a line of the cache with the next, nor the pair of lines that is fetched together.
template <class Primitives>
struct alignas(2 * cache_line) Part {
  struct Leaf {
    std::uint32_t triangles, others;
  };

  Part(const Primitives& none, MemoryMeter& meter)
      : all(none),
        nodes(MeteredAllocator<BrickNode>(meter)),
        leaves(MeteredAllocator<Leaf>(meter)),
        masks(MeteredAllocator<std::uint64_t>(meter)),
        primitives(MeteredAllocator<std::uint32_t>(meter)) {}

  Primitives all;
  MeteredVector<BrickNode> nodes;
  MeteredVector<Leaf> leaves;
  MeteredVector<std::uint64_t> masks;       // of leaf after leaf, as LeafWords has them
  MeteredVector<std::uint32_t> primitives;  // of leaf after leaf, as `all` numbers them
  std::uint64_t words = 0;
  std::uint32_t depth = 0;

  /// Of triangles in the order in which they are to be tested; `cells`: of each.
  void make_leaf(BrickNode& leaf, std::span<const std::uint32_t> triangles,
                 std::span<const std::uint64_t> cells, std::span<const std::uint32_t> others) {
    words = LeafWords::begin(words, triangles.size());
    leaf.base = static_cast<std::uint32_t>(words);
    leaf.triangles = static_cast<std::uint32_t>(triangles.size());
    leaf.others = static_cast<std::uint32_t>(others.size());
    leaves.push_back({leaf.triangles, leaf.others});
    primitives.insert(primitives.end(), triangles.begin(), triangles.end());
    primitives.insert(primitives.end(), others.begin(), others.end());
    if (LeafWords::has_masks(leaf.triangles))
      for (std::size_t first = 0; first < triangles.size(); first += LeafWords::block) {
        std::uint64_t mask = 0;
        for (std::size_t i = first; i < std::min(triangles.size(), first + LeafWords::block); ++i)
          mask |= cells[i];
        masks.push_back(mask);
      }
    words += LeafWords::count(leaf.triangles) + others.size();
    if (words > most_numbered) refuse();
  }

  /// Where the words of another part may begin.
  std::uint64_t end_of_words() const { return LeafWords::begin(words, LeafWords::block); }

  /// Writes the words of all leaves, at their place.
  void write_leaves(std::uint32_t* first) const {
    std::uint32_t* to = first;
    const std::uint32_t* next = primitives.data();
    const std::uint64_t* mask = masks.data();
    for (const Leaf& leaf : leaves) {
      std::uint32_t* const begin =
          first + LeafWords::begin(static_cast<std::uint64_t>(to - first), leaf.triangles);
      to = std::fill_n(to, begin - to, 0u);
      for (std::uint32_t i = 0; i < leaf.triangles; ++i)
        LeafWords::put(to, leaf.triangles, i, all.triangle(next[i]), all.primitive(next[i]));
      next += leaf.triangles;
      to += TriangleRows::rows * leaf.triangles;
      for (std::size_t i = 0; i < LeafWords::masks(leaf.triangles); ++i, ++mask) {
        *to++ = static_cast<std::uint32_t>(*mask);
        *to++ = static_cast<std::uint32_t>(*mask >> 32u);
      }
      to = std::transform(next, next + leaf.others, to, [&](std::uint32_t p) { return all.primitive(p); });
      next += leaf.others;
    }
    std::fill(to, first + end_of_words(), 0u);
  }
};

/// Sorts a leaf's triangles so that neighbours in the array are neighbours in space.
class LeafOrder {
 public:
  explicit LeafOrder(MemoryMeter& meter)
      : triangles_(MeteredAllocator<std::uint32_t>(meter)), cells_(MeteredAllocator<std::uint64_t>(meter)) {}

  /// By the first of the cells that they meet, along a Z-order curve (Morton 1966).
  void sort(std::span<std::uint32_t> triangles, std::span<std::uint64_t> cells) {
    if (!LeafWords::has_masks(triangles.size())) return;
    triangles_.assign(triangles.begin(), triangles.end());
    cells_.assign(cells.begin(), cells.end());
    CellCounts counts{}, places;
    for (const std::uint64_t mask : cells_) ++counts[key(mask)];
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0u);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t place = places[key(cells_[i])]++;
      triangles[place] = triangles_[i];
      cells[place] = cells_[i];
    }
  }

 private:
  static constexpr std::array<std::uint8_t, 64> z_order() {
    std::array<std::uint8_t, 64> order{};
    for (unsigned cell = 0; cell < 64; ++cell)
      for (unsigned axis = 0; axis < 3; ++axis)
        order[cell] = static_cast<std::uint8_t>(order[cell] | (cell >> (2 * axis) & 1u) << axis |
                                                (cell >> (2 * axis + 1) & 1u) << (axis + 3));
    return order;
  }
  static std::size_t key(std::uint64_t mask) {
    static constexpr auto order = z_order();
    return order[static_cast<unsigned>(std::countr_zero(mask | std::uint64_t{1} << 63u))];
  }

  MeteredVector<std::uint32_t> triangles_;  // as they were, and their cells
  MeteredVector<std::uint64_t> cells_;
};

/// Makes nodes and all that is below them, on one thread.
template <class Primitives>
class TreeBuilder {
 public:
  TreeBuilder(const NodeRules& rules, MemoryMeter& meter)
      : rules_(rules),
        order_(meter),
        stack_(MeteredAllocator<std::uint32_t>(meter)),
        cells_(MeteredAllocator<std::uint64_t>(meter)) {}

  /// Adds what is below the task's node to `part`.
  void make(Task& task, Part<Primitives>& part) {
    const std::size_t count = task.primitives.size();
    part.all.add(task.primitives, stack_);
    if (!task.block) {
      task.made = node_of(0, count, task.cell, task.level, task.duplication, part);
      return;
    }
    CutBrick brick = rules_.block(*task.block);
    CellCounts counts{};
    find_cells(brick, gathered(0, count, part), others(0, count, part));
    rules_.count(std::span(cells_).first(count), counts);
    add_children(brick.node, 0, count, counts, part, [&](std::size_t first, unsigned bit) {
      return node_of(first, counts[bit], rules_.root_box(*task.block, bit), 0, 1, part);
    });
    task.made = brick.node;
  }

 private:
  /// The primitives that lie in stack_ from `first` on.
  std::span<const std::uint32_t> primitives(std::size_t first, std::size_t count) const {
    return std::span(stack_).subspan(first, count);
  }
  GatheredTriangles<Primitives> gathered(std::size_t first, std::size_t count, const Part<Primitives>& part) {
    const auto some = primitives(first, count);
    return {part.all, some.first(rules_.triangles_among(part.all, some)), buffer_};
  }
  /// As the scene numbers them.
  auto others(std::size_t first, std::size_t count, const Part<Primitives>& part) const {
    const auto some = primitives(first, count);
    return some.subspan(rules_.triangles_among(part.all, some)) |
           std::views::transform([&all = part.all](std::uint32_t p) { return all.primitive(p); });
  }

  /// A node and what is below it.
  BrickNode node_of(std::size_t first, std::size_t count, const Box& cell, std::uint32_t level,
                    double duplication, Part<Primitives>& part) {
    part.depth = std::max(part.depth, level);
    const auto triangles = gathered(first, count, part);
    CutBrick brick = rules_.cut(rules_.bounds_of(triangles, others(first, count, part)), cell);
    find_cells(brick, triangles, others(first, count, part));

    if (rules_.may_split(brick, count, level)) {
      CellCounts counts{};
      rules_.count(std::span(cells_).first(count), counts);
      const double more = double(sum_of(counts)) / double(count);
      if (rules_.splits(brick, counts, count, duplication)) {
        add_children(brick.node, first, count, counts, part, [&](std::size_t child, unsigned bit) {
          return node_of(child, counts[bit], cell_of(brick.node, bit), level + 1, duplication * more, part);
        });
        return brick.node;
      }
    }
    const std::size_t among = triangles.all().size();
    order_.sort(std::span(stack_).subspan(first, among), std::span(cells_).first(among));
    part.make_leaf(brick.node, primitives(first, among), std::span(cells_).first(among),
                   primitives(first, count).subspan(among));
    return brick.node;
  }

  /// Of each primitive the cells that it meets, and all of them in the node's mask.
  template <class Others>
  void find_cells(CutBrick& brick, const GatheredTriangles<Primitives>& triangles, const Others& others) {
    const std::size_t count = triangles.all().size() + others.size();
    if (cells_.size() < count) cells_.resize(count);
    const auto cells = std::span(cells_).first(count);
    rules_.cells_of(brick, triangles, others, cells);
    for (const std::uint64_t mask : cells) brick.node.occupied |= mask;
  }

  /// Gives each occupied cell a list of its primitives, at the end of stack_, and a child, child(where the
  /// list begins, cell).
  template <class Child>
  void add_children(BrickNode& node, std::size_t first, std::size_t count, const CellCounts& counts,
                    Part<Primitives>& part, const Child& child) {
    const std::size_t lists = stack_.size(), base = part.nodes.size();
    stack_.resize(lists + sum_of(counts));
    CellCounts places;
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0u);
    distribute(primitives(first, count), cells_, places, stack_.data() + lists);
    node.base = static_cast<std::uint32_t>(base);
    part.nodes.resize(base + static_cast<std::size_t>(std::popcount(node.occupied)));
    std::size_t list = lists;
    for (std::uint64_t rest = node.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      const BrickNode made = child(list, bit);
      part.nodes[node.child(bit)] = made;
      list += counts[bit];
    }
    stack_.resize(lists);
  }

  const NodeRules& rules_;
  GatherBuffer buffer_;
  LeafOrder order_;
  MeteredVector<std::uint32_t> stack_;
  MeteredVector<std::uint64_t> cells_;  // by primitive, of the node that is being made
};

/// Nodes that are too much for one thread.
class LargeNodes {
 public:
  LargeNodes(const NodeRules& rules, MemoryMeter& meter)
      : part(ScenePrimitives(rules.scene()), meter), rules_(rules), meter_(meter) {}

  /// Makes the task's node, on all threads, and adds tasks for its children, whose nodes have their places in
  /// `part`.
  void make(Task& task, MeteredVector<Task>& children) {
    const auto primitives = task.primitives;
    const std::size_t count = primitives.size(), chunks = (count + chunk_size - 1) / chunk_size;
    const auto part_of = [&](const auto& all, std::size_t chunk) {
      return all.subspan(chunk * chunk_size, std::min(chunk_size, count - chunk * chunk_size));
    };
    // Calls use(chunk, its triangles, its others) for each chunk of the primitives.
    const auto for_chunks = [&](const auto& use) {
      for_ranges(chunks, 1, [&](std::uint64_t begin, std::uint64_t end) {
        GatherBuffer buffer;
        for (std::uint64_t chunk = begin; chunk < end; ++chunk) {
          const auto these = part_of(primitives, chunk);
          const std::size_t triangles = rules_.triangles_among(part.all, these);
          use(chunk, GatheredTriangles(part.all, these.first(triangles), buffer), these.subspan(triangles));
        }
      });
    };

    CutBrick brick;
    if (task.block) {
      brick = rules_.block(*task.block);
    } else {
      part.depth = std::max(part.depth, task.level);
      MeteredVector<Bounds> bounds(chunks, MeteredAllocator<Bounds>(meter_));
      for_chunks([&](std::size_t chunk, const auto& triangles, auto others) {
        bounds[chunk] = rules_.bounds_of(triangles, others);
      });
      for (const Bounds& box : bounds) bounds[0].extend(box);
      brick = rules_.cut(bounds[0], task.cell);
    }

    MeteredVector<std::uint64_t> all_cells(count, MeteredAllocator<std::uint64_t>(meter_));
    const std::span<std::uint64_t> cells(all_cells);
    MeteredVector<CellCounts> places(chunks, MeteredAllocator<CellCounts>(meter_));
    for_chunks([&](std::size_t chunk, const auto& triangles, auto others) {
      rules_.cells_of(brick, triangles, others, part_of(cells, chunk));
      rules_.count(part_of(cells, chunk), places[chunk]);
    });
    CellCounts counts{};
    for (const CellCounts& in_chunk : places)
      for (std::size_t i = 0; i < 64; ++i) counts[i] += in_chunk[i];
    for (std::size_t i = 0; i < 64; ++i) brick.node.occupied |= std::uint64_t{counts[i] != 0} << i;
    if (!task.block && !(rules_.may_split(brick, count, task.level) &&
                         rules_.splits(brick, counts, count, task.duplication))) {
      const std::size_t triangles = rules_.triangles_among(part.all, primitives);
      std::vector<std::uint32_t> ordered(primitives.begin(), primitives.end());
      LeafOrder(meter_).sort(std::span(ordered).first(triangles), cells.first(triangles));
      part.make_leaf(brick.node, std::span(ordered).first(triangles), cells.first(triangles),
                     primitives.subspan(triangles));
      task.made = brick.node;
      return;
    }

    // Where each chunk's primitives begin in each cell's list.
    CellCounts place;
    std::exclusive_scan(counts.begin(), counts.end(), place.begin(), 0u);
    for (CellCounts& in_chunk : places)
      for (std::size_t i = 0; i < 64; ++i) place[i] += std::exchange(in_chunk[i], place[i]);
    const std::uint64_t references = sum_of(counts);
    std::uint32_t* list = lists_.emplace_back(references, MeteredAllocator<std::uint32_t>(meter_)).data();
    for_ranges(chunks, 16, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t chunk = begin; chunk < end; ++chunk)
        distribute(part_of(primitives, chunk), part_of(cells, chunk), places[chunk], list);
    });

    brick.node.base = static_cast<std::uint32_t>(part.nodes.size());
    task.made = brick.node;
    Task child;
    if (!task.block) {
      child.level = task.level + 1;
      child.duplication = task.duplication * double(references) / double(count);
    }
    const auto block = task.block;  // `task` may move
    for (std::uint64_t rest = brick.node.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      child.primitives = {list, counts[bit]};
      child.cell = block ? rules_.root_box(*block, bit) : cell_of(brick.node, bit);
      child.place = brick.node.child(bit);
      children.push_back(child);
      list += counts[bit];
    }
    part.nodes.resize(part.nodes.size() + static_cast<std::size_t>(std::popcount(brick.node.occupied)));
  }

  Part<ScenePrimitives> part;

 private:
  static constexpr std::size_t chunk_size = GatherBuffer::capacity;

  const NodeRules& rules_;
  MemoryMeter& meter_;
  std::vector<MeteredVector<std::uint32_t>> lists_;  // that the children's primitives lie in
};

/// For all nodes and words that come before the end.
void make_room(const Place& end, Bricks& bricks) {
  if (std::max(end.node, end.word + widest_vector) >= most_numbered) refuse();
  bricks.nodes.grow(end.node);
  bricks.words.grow(end.word + widest_vector);
}

/// Makes the nodes of all tasks but the large ones and what is below them, and writes their leaves, from
/// `end` on, which moves. Where the bricks `can_grow` where they are, each part's leaves are written while
/// what they are made of is at hand, and take its place in memory.
template <class Primitives>
void make_parts(const NodeRules& rules, std::span<Task> tasks, const Primitives& none, bool can_grow,
                MemoryMeter& meter, Place& end, Bricks& bricks) {
  // Of about as many references each, whatever the number of threads.
  std::vector<std::size_t> begins{0};
  std::size_t references = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!tasks[i].is_large()) references += tasks[i].primitives.size();
    if (references >= part_size || i + 1 == tasks.size()) {
      begins.push_back(i + 1);
      references = 0;
    }
  }
  const auto for_small_tasks = [&](std::size_t part, const auto& use) {
    for (std::size_t i = begins[part]; i < begins[part + 1]; ++i)
      if (!tasks[i].is_large()) use(tasks[i]);
  };
  std::vector<Part<Primitives>> parts(begins.size() - 1, Part<Primitives>(none, meter));
  std::vector<Place> places(parts.size());

  const auto make = [&](TreeBuilder<Primitives>& builder, std::uint64_t p) {
    for_small_tasks(p, [&](Task& task) { builder.make(task, parts[p]); });
  };
  const auto place = [&](std::uint64_t p) {
    places[p] = end;
    end.node += parts[p].nodes.size();
    end.word += parts[p].end_of_words();
    bricks.depth = std::max(bricks.depth, parts[p].depth);
  };
  const auto write = [&](std::uint64_t p) {
    const Part<Primitives> part = std::move(parts[p]);
    const auto move = [&](BrickNode& node) {
      node.base += static_cast<std::uint32_t>(node.is_leaf() ? places[p].word : places[p].node);
    };
    for_small_tasks(p, [&](Task& task) { move(task.made); });
    BrickNode* to = bricks.nodes.data() + places[p].node;
    for (const BrickNode& node : part.nodes) move(*to++ = node);
    part.write_leaves(bricks.words.data() + places[p].word);
  };

  if (can_grow) {
    for_each_in_order(
        parts.size(),
        [&](std::uint64_t p) {
          TreeBuilder<Primitives> builder(rules, meter);
          make(builder, p);
        },
        [&](std::uint64_t p) {
          place(p);
          make_room(end, bricks);
        },
        write);
    return;
  }
  for_ranges(parts.size(), 1, [&](std::uint64_t first, std::uint64_t last) {
    TreeBuilder<Primitives> builder(rules, meter);
    for (std::uint64_t p = first; p < last; ++p) make(builder, p);
  });
  for (std::uint64_t p = 0; p < parts.size(); ++p) place(p);
  make_room(end, bricks);
  for_ranges(parts.size(), 1, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t p = first; p < last; ++p) write(p);
  });
}

}  // namespace

void build_bricks(const Scene& scene, const BrickOptions& options, MemoryMeter& meter, Bricks& bricks) {
  const NodeRules rules(scene, bricks, options);
  MeteredVector<Task> tasks{MeteredAllocator<Task>(meter)};
  SparseLists lists(meter);
  lists.build(rules.block_count(), scene.primitive_count(),
              [&](std::uint32_t begin, std::uint32_t end, const auto& add) {
                for (std::uint32_t p = begin; p < end; ++p)
                  rules.for_each_row_near(
                      p, [&](std::uint64_t first, std::uint32_t count) { add(p, first, count); });
                return true;
              });
  for (std::uint32_t block = 0; block < lists.cells(); ++block)
    if (!lists[block].empty()) tasks.push_back({.primitives = lists[block], .block = block});

  LargeNodes large(rules, meter);
  for (std::size_t i = 0; i < tasks.size(); ++i)
    if (tasks[i].is_large()) large.make(tasks[i], tasks);

  // All together, the large nodes first.
  Place end{large.part.nodes.size(), large.part.end_of_words()};
  bricks.depth = large.part.depth;
  const bool is_far = scene.vertices().size_bytes() + scene.triangles().size_bytes() >= far_bytes;
  if (is_far && bricks.nodes.set_aside(most_numbered) && bricks.words.set_aside(most_numbered))
    make_parts(rules, std::span(tasks), LocalPrimitives(scene, meter), true, meter, end, bricks);
  else
    make_parts(rules, std::span(tasks), ScenePrimitives(scene), false, meter, end, bricks);
  make_room(end, bricks);
  bricks.nodes.give_back();
  bricks.words.give_back();
  large.part.write_leaves(bricks.words.data());
  std::fill_n(bricks.words.data() + end.word, widest_vector, 0u);
  bricks.roots.assign(cell_count(bricks.cells.n), Bricks::empty_cell);
  bricks.root_boxes.assign(bricks.roots.size(), {});
  for (const Task& task : tasks)
    if (!task.block) bricks.nodes[task.place] = task.made;
  for (const Task& task : tasks) {
    if (!task.block) continue;
    for (std::uint64_t rest = task.made.occupied; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(rest));
      const std::uint64_t cell = rules.root_cell(*task.block, bit);
      const std::uint32_t root = task.made.child(bit);
      bricks.roots[cell] = root;
      bricks.root_boxes[cell] = rules.root_box_of(*task.block, bit, bricks.nodes[root]);
    }
  }
}

}  // namespace raymeter
