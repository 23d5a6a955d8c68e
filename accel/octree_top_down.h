#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/octree_cells.h"

namespace raymeter {

/// The walk of Revelles, Urena and Lastra, "An Efficient Parametric Algorithm for Octree Traversal" (2000):
/// from the root down, the children of each node in the order in which the ray crosses the node's middle
/// planes. The nodes are Glassner's, kept in an array with the eight children of a node side by side instead
/// of in his hash table. Unlike the paper's, the middle crossings are computed from the planes and not as the
/// mean of the outer ones, and a direction of 0 needs no infinite arithmetic: it never changes sides.
class TopDownOctree {
 public:
  TopDownOctree(OctreeCells tree, MemoryMeter&)
      : space_(tree.space), nodes_(std::move(tree.nodes)), references_(std::move(tree.references)) {}

  /// As GlassnerOctree::walk.
  template <class Query, class Probe>
  void walk(const WalkRay& ray, const WalkInterval& interval, Query& query, Probe& probe) const {
    unsigned mirror = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (ray.direction[axis] < 0) mirror |= 1u << axis;
    const Walk<Query, Probe> state{ray, mirror, query, probe};
    visit(state, nodes_[0], {0, 0, 0}, space_.cells, interval.enter, interval.leave);
  }

  std::vector<std::pair<std::string, std::uint64_t>> bytes_by_part() const {
    return {{"nodes", nodes_.capacity() * sizeof(OctreeNode)},
            {"references", references_.capacity() * sizeof(std::uint32_t)}};
  }

 private:
  template <class Query, class Probe>
  struct Walk {
    const WalkRay& ray;
    unsigned mirror;  // bit a: the ray runs from high to low along axis a
    Query& query;
    Probe& probe;
  };

  /// Visits what the ray meets of a node between t = enter and leave; false when the walk is over.
  template <class Query, class Probe>
  bool visit(const Walk<Query, Probe>& walk, const OctreeNode& node, const CellIndex& corner,
             std::int32_t size, double enter, double leave) const {
    if (!node.is_inner()) {
      walk.query.visit(std::span(references_).subspan(node.first, node.count));
      return true;
    }
    walk.probe.inner_step();

    // Finds where the ray crosses the middle planes, and in which half along each axis it starts: bit a of
    // `half` is set when it is in the one it comes to later.
    const std::int32_t child_size = size >> 1;
    Vec3d middle;
    unsigned half = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double plane = space_.plane(axis, corner[axis] + child_size);
      constexpr double never = std::numeric_limits<double>::infinity();
      if (walk.ray.direction[axis] == 0)
        middle[axis] = walk.ray.origin[axis] < plane ? never : -never;
      else
        middle[axis] = (plane - walk.ray.origin[axis]) * walk.ray.inverse[axis];
      if (middle[axis] <= enter) half |= 1u << axis;
    }

    // Visits a child, then steps across the next middle plane, until the ray leaves the node.
    while (true) {
      int next_axis = -1;
      double next = leave;
      for (int axis = 0; axis < 3; ++axis)
        if ((half >> axis & 1u) == 0 && middle[axis] < next) {
          next = middle[axis];
          next_axis = axis;
        }
      const unsigned child = half ^ walk.mirror;
      if (!visit(walk, nodes_[node.first + child], child_corner(corner, child, child_size), child_size, enter,
                 next))
        return false;
      if (next_axis < 0) return true;
      if (next > walk.query.last()) return false;
      enter = next;
      half |= 1u << next_axis;
    }
  }

  OctreeSpace space_;
  MeteredVector<OctreeNode> nodes_;
  MeteredVector<std::uint32_t> references_;
};

}  // namespace raymeter
