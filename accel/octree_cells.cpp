#include "accel/octree_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "accel/cell_overlap.h"
#include "accel/parallel.h"

namespace raymeter {
namespace {

/// The nodes of one level that are still to be looked at. Node `first_node + i` has corner `corners[i]`;
/// until it is settled, its `first` and `count` point into `references`.
struct Level {
  explicit Level(MemoryMeter& meter)
      : corners(MeteredAllocator<CellIndex>(meter)), references(MeteredAllocator<std::uint32_t>(meter)) {}

  int depth = 0;
  std::size_t first_node = 0;
  MeteredVector<CellIndex> corners;
  MeteredVector<std::uint32_t> references;
};

/// Some references of a node that may be split: what one thread works on at a time.
struct Piece {
  std::uint32_t node;                       // of the level
  std::uint32_t begin, end;                 // in the level's references
  std::array<std::uint32_t, 8> children{};  // how many meet each child; then where in the next level they go
};
constexpr std::uint32_t piece_size = 4096;

class OctreeBuilder {
 public:
  OctreeBuilder(const Scene& scene, std::uint32_t leaf, int depth, MemoryMeter& meter)
      : scene_(scene),
        leaf_(leaf),
        maximum_depth_(depth),
        limit_(std::min<std::uint64_t>(32 * scene.primitive_count() + 65536, OctreeNode::inner - 8)),
        meter_(meter),
        bounds_(MeteredAllocator<Bounds>(meter)),
        children_of_(MeteredAllocator<std::uint8_t>(meter)),
        pieces_(MeteredAllocator<Piece>(meter)),
        tree_(meter) {
    tree_.space = OctreeSpace(scene.bounds(), depth);
  }

  OctreeCells build() {
    // The root holds every primitive.
    const auto primitives = static_cast<std::uint32_t>(scene_.primitive_count());
    Level level(meter_);
    bounds_.resize(primitives);
    level.references.resize(primitives);
    for_ranges(primitives, 4096, [&](std::uint64_t begin, std::uint64_t end) {
      for (auto p = static_cast<std::uint32_t>(begin); p < end; ++p) {
        bounds_[p] = scene_.bounds_of(p);
        level.references[p] = p;
      }
    });
    level.corners.push_back({0, 0, 0});
    tree_.nodes.push_back({0, primitives});
    total_references_ = primitives;

    // Each node of a level is split or becomes a leaf; the children are the next level. What costs time is
    // done by all threads; what is decided, node by node, so that the tree does not depend on them.
    for (; !level.corners.empty(); level = next_level(level)) tree_.depth = level.depth;

    tree_.nodes.shrink_to_fit();
    tree_.references.shrink_to_fit();
    if (cells_kept_whole_ != 0)
      tree_.note = fmt::format(
          "{} cells above leaf={} were not split: the tree is kept within {} references and nodes",
          cells_kept_whole_, leaf_, limit_);
    return std::move(tree_);
  }

 private:
  Level next_level(const Level& level) {
    find_children(level);
    Level next(meter_);
    next.depth = level.depth + 1;
    next.first_node = tree_.nodes.size();
    std::size_t piece = 0, references = 0;
    for (std::uint32_t node = 0; node < level.corners.size(); ++node) {
      const std::size_t first_piece = piece;
      while (piece < pieces_.size() && pieces_[piece].node == node) ++piece;
      const std::span<Piece> pieces(pieces_.data() + first_piece, piece - first_piece);
      if (!split(level, node, pieces, next, references)) {
        for (Piece& of_leaf : pieces) of_leaf.end = of_leaf.begin;  // nothing of it goes to the next level
        settle(level, node);
      }
    }
    next.references.resize(references);
    hand_down(level, next);
    return next;
  }

  std::int32_t child_size(const Level& level) const { return tree_.space.cells >> (level.depth + 1); }

  /// For each node of the level that could be split, and each of its primitives: the children that it meets.
  void find_children(const Level& level) {
    pieces_.clear();
    if (level.depth == maximum_depth_) return;
    for (std::uint32_t node = 0; node < level.corners.size(); ++node) {
      const auto [first, count] = tree_.nodes[level.first_node + node];
      // Where there may be no room for the children, as each primitive may meet several: see split.
      if (count <= leaf_ || total_references_ + count > limit_) continue;
      for (std::uint32_t begin = 0; begin < count; begin += piece_size)
        pieces_.push_back({node, first + begin, first + std::min(count, begin + piece_size)});
    }
    children_of_.resize(level.references.size());
    for_ranges(pieces_.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        Piece& piece = pieces_[i];
        for (std::uint32_t r = piece.begin; r < piece.end; ++r) {
          children_of_[r] = children_met(level.references[r], level.corners[piece.node], child_size(level));
          for (unsigned child = 0; child < 8; ++child) piece.children[child] += children_of_[r] >> child & 1u;
        }
      }
    });
  }

  /// Splits a node if that is wanted, useful and allowed. `references` is how many the next level has so far.
  bool split(const Level& level, std::uint32_t node, std::span<Piece> pieces, Level& next,
             std::size_t& references) {
    const std::uint32_t count = tree_.nodes[level.first_node + node].count;
    if (count <= leaf_ || level.depth == maximum_depth_) return false;

    // Keeps the node whole where there may be no room for its children, where splitting separates nothing, or
    // where it would cost more than is allowed.
    if (pieces.empty() || total_references_ + count > limit_ || tree_.nodes.size() + 8 > limit_) {
      ++cells_kept_whole_;
      return false;
    }
    std::array<std::uint32_t, 8> counts{};
    for (const Piece& piece : pieces)
      for (std::size_t child = 0; child < 8; ++child) counts[child] += piece.children[child];
    if (std::ranges::all_of(counts, [&](std::uint32_t n) { return n == count; })) return false;
    std::uint64_t total = total_references_ - count;
    for (const std::uint32_t n : counts) total += n;
    if (total > limit_) {
      ++cells_kept_whole_;
      return false;
    }
    total_references_ = total;

    // Adds the children to the next level, and says where the pieces' references go.
    tree_.nodes[level.first_node + node] = {static_cast<std::uint32_t>(tree_.nodes.size()),
                                            OctreeNode::inner};
    ++tree_.inner_nodes;
    for (unsigned child = 0; child < 8; ++child) {
      tree_.nodes.push_back({static_cast<std::uint32_t>(references), counts[child]});
      next.corners.push_back(child_corner(level.corners[node], child, child_size(level)));
      for (Piece& piece : pieces)
        references += std::exchange(piece.children[child], static_cast<std::uint32_t>(references));
    }
    return true;
  }

  /// Copies the references of the nodes that were split to their children.
  void hand_down(const Level& level, Level& next) {
    for_ranges(pieces_.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        Piece& piece = pieces_[i];
        for (std::uint32_t r = piece.begin; r < piece.end; ++r)
          for (unsigned child = 0; child < 8; ++child)
            if (children_of_[r] >> child & 1u) next.references[piece.children[child]++] = level.references[r];
      }
    });
  }

  /// Makes a node a leaf.
  void settle(const Level& level, std::uint32_t node) {
    auto& [first, count] = tree_.nodes[level.first_node + node];
    const auto begin = level.references.begin() + first;
    first = static_cast<std::uint32_t>(tree_.references.size());
    tree_.references.insert(tree_.references.end(), begin, begin + count);
    ++tree_.leaves;
    tree_.empty_leaves += count == 0;
  }

  /// The children, as bits, that a primitive of the node at `corner` meets; they are `half` finest cells
  /// wide.
  std::uint8_t children_met(std::uint32_t primitive, const CellIndex& corner, std::int32_t half) const {
    const Bounds& box = bounds_[primitive];
    const double margin = tree_.space.scene.margin;
    constexpr std::array<unsigned, 3> high_children{0b10101010, 0b11001100, 0b11110000};
    unsigned met = 0xff;
    for (int axis = 0; axis < 3; ++axis) {
      const double middle = tree_.space.plane(axis, corner[axis] + half);
      const unsigned high = high_children[static_cast<unsigned>(axis)];
      if (box.low[axis] - margin > middle) met &= high;
      if (box.high[axis] + margin < middle) met &= ~high;
    }
    // The primitive meets the node, so it meets the only child that its bounding box meets.
    if (std::has_single_bit(met)) return static_cast<std::uint8_t>(met);

    // Twice the margin, as in cell_overlap.h: once for the walk, once for the rounding of the tests.
    const double half_edge = 0.5 * half * tree_.space.cell, slack = 2 * margin;
    const Vec3d half_size{half_edge, half_edge, half_edge};
    return with_overlap(scene_, primitive, half_size, slack,
                        [&](const auto& overlap) { return of_these(met, overlap, corner, half); });
  }

  /// Of `candidates`, the children that `overlap` meets.
  template <class Overlap>
  std::uint8_t of_these(unsigned candidates, const Overlap& overlap, const CellIndex& corner,
                        std::int32_t half) const {
    unsigned met = 0;
    for (unsigned child = 0; child < 8; ++child)
      if ((candidates >> child & 1u) != 0 &&
          overlap.meets(tree_.space.centre(child_corner(corner, child, half), half)))
        met |= 1u << child;
    return static_cast<std::uint8_t>(met);
  }

  const Scene& scene_;
  std::uint32_t leaf_;
  int maximum_depth_;
  std::uint64_t limit_;
  MemoryMeter& meter_;
  MeteredVector<Bounds> bounds_;
  MeteredVector<std::uint8_t> children_of_;  // for each reference of the level's pieces a bit per child
  MeteredVector<Piece> pieces_;              // of the level, node by node
  std::uint64_t total_references_ = 0, cells_kept_whole_ = 0;
  OctreeCells tree_;
};

}  // namespace

OctreeCells build_octree_cells(const Scene& scene, std::uint32_t leaf, int depth, MemoryMeter& meter) {
  if (scene.bounds().empty()) return OctreeCells(meter);
  return OctreeBuilder(scene, leaf, depth, meter).build();
}

}  // namespace raymeter
