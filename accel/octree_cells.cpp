#include "accel/octree_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "accel/cell_overlap.h"

namespace raymeter {
namespace {

/// The nodes of one level that are still to be looked at. Node `first_node + i` has corner `corners[i]`;
/// until it is settled, its `first` and `count` point into `references`.
struct Level {
  explicit Level(MemoryMeter& meter)
      : corners(MeteredAllocator<CellIndex>(meter)), references(MeteredAllocator<std::uint32_t>(meter)) {}

  std::size_t first_node = 0;
  MeteredVector<CellIndex> corners;
  MeteredVector<std::uint32_t> references;
};

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
        tree_(meter) {
    tree_.space = OctreeSpace(scene.bounds(), depth);
  }

  OctreeCells build() {
    // The root holds every primitive.
    const auto primitives = static_cast<std::uint32_t>(scene_.primitive_count());
    Level level(meter_);
    bounds_.reserve(primitives);
    level.references.reserve(primitives);
    for (std::uint32_t primitive = 0; primitive < primitives; ++primitive) {
      bounds_.push_back(scene_.bounds_of(primitive));
      level.references.push_back(primitive);
    }
    level.corners.push_back({0, 0, 0});
    tree_.nodes.push_back({0, primitives});
    total_references_ = primitives;

    // Each node of a level is split or becomes a leaf; the children are the next level.
    for (int depth = 0; !level.corners.empty(); ++depth) {
      tree_.depth = depth;
      Level next(meter_);
      next.first_node = tree_.nodes.size();
      for (std::size_t i = 0; i < level.corners.size(); ++i) {
        const std::size_t node = level.first_node + i;
        if (!split(node, level, level.corners[i], depth, next)) settle(node, level);
      }
      level = std::move(next);
    }

    tree_.nodes.shrink_to_fit();
    tree_.references.shrink_to_fit();
    if (cells_kept_whole_ != 0)
      tree_.note = fmt::format(
          "{} cells above leaf={} were not split: the tree is kept within {} references and nodes",
          cells_kept_whole_, leaf_, limit_);
    return std::move(tree_);
  }

 private:
  /// Splits a node if that is wanted, useful and allowed.
  bool split(std::size_t node, const Level& level, const CellIndex& corner, int depth, Level& next) {
    const auto [first, count] = tree_.nodes[node];
    if (count <= leaf_ || depth == maximum_depth_) return false;

    // Keeps the node whole where there may be no room for its children: each primitive may meet several.
    if (total_references_ + count > limit_ || tree_.nodes.size() + 8 > limit_) {
      ++cells_kept_whole_;
      return false;
    }

    // Finds for each primitive the children that it meets.
    const std::int32_t half = tree_.space.cells >> (depth + 1);
    std::array<std::uint32_t, 8> counts{};
    children_of_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      children_of_[i] = children_met(level.references[first + i], corner, half);
      for (unsigned child = 0; child < 8; ++child) counts[child] += children_of_[i] >> child & 1u;
    }

    // Keeps the node whole where splitting separates nothing, or would cost more than is allowed.
    if (std::ranges::all_of(counts, [&](std::uint32_t n) { return n == count; })) return false;
    std::uint64_t references = total_references_ - count;
    for (const std::uint32_t n : counts) references += n;
    if (references > limit_) {
      ++cells_kept_whole_;
      return false;
    }
    total_references_ = references;

    // Adds the children to the next level.
    tree_.nodes[node] = {static_cast<std::uint32_t>(tree_.nodes.size()), OctreeNode::inner};
    ++tree_.inner_nodes;
    std::array<std::size_t, 8> end{};
    std::size_t offset = next.references.size();
    for (unsigned child = 0; child < 8; ++child) {
      tree_.nodes.push_back({static_cast<std::uint32_t>(offset), counts[child]});
      next.corners.push_back(child_corner(corner, child, half));
      end[child] = offset;
      offset += counts[child];
    }
    next.references.resize(offset);
    for (std::uint32_t i = 0; i < count; ++i)
      for (unsigned child = 0; child < 8; ++child)
        if (children_of_[i] >> child & 1u) next.references[end[child]++] = level.references[first + i];
    return true;
  }

  /// Makes a node a leaf.
  void settle(std::size_t node, const Level& level) {
    const auto [first, count] = tree_.nodes[node];
    tree_.nodes[node].first = static_cast<std::uint32_t>(tree_.references.size());
    const auto begin = level.references.begin() + first;
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
    if (scene_.is_triangle(primitive))
      return of_these(met, TriangleOverlap(scene_.triangle(primitive), half_size, slack), corner, half);
    const Quadric& quadric = scene_.quadric(primitive);
    if (quadric.kind == QuadricKind::sphere)
      return of_these(met, SphereOverlap(quadric, half_size, slack), corner, half);
    return static_cast<std::uint8_t>(met);
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
  MeteredVector<std::uint8_t> children_of_;  // of the node being split: for each reference a bit per child
  std::uint64_t total_references_ = 0, cells_kept_whole_ = 0;
  OctreeCells tree_;
};

}  // namespace

OctreeCells build_octree_cells(const Scene& scene, std::uint32_t leaf, int depth, MemoryMeter& meter) {
  if (scene.bounds().empty()) return OctreeCells(meter);
  return OctreeBuilder(scene, leaf, depth, meter).build();
}

}  // namespace raymeter
