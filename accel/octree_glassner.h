#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/octree_cells.h"
#include "accel/octree_names.h"

namespace raymeter {

/// Glassner's walk ("Space Subdivision for Fast Ray Tracing", IEEE CG&A 4(10), 1984): the leaf of a point is
/// found by going down from the root, name by name; the next leaf is that of a point just outside the
/// present one, where the ray leaves it.
class GlassnerOctree {
 public:
  GlassnerOctree(OctreeCells tree, MemoryMeter& meter)
      : space_(tree.space), names_(tree, meter), references_(std::move(tree.references)) {}

  /// Shows `query` (cell_query.h) the leaves that the ray meets in `interval`, in order.
  template <class Query, class Probe>
  void walk(const WalkRay& ray, const WalkInterval& interval, Query& query, Probe& probe) const {
    double enter = interval.enter;
    CellIndex cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = space_.index_at(axis, ray.origin[axis] + enter * ray.direction[axis]);

    while (true) {
      const Leaf leaf = locate(cell, probe);
      query.visit(std::span(references_).subspan(leaf.node.first, leaf.node.count));

      // Finds the face of the leaf through which the ray leaves: the first of three planes to be crossed.
      CellIndex corner, last;
      int exit_axis = 0;
      double exit = std::numeric_limits<double>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = cell[axis] & -leaf.size;
        last[axis] = corner[axis] + leaf.size - 1;
        const bool rising = ray.direction[axis] > 0;
        const double t = ray.crossing(axis, space_.plane(axis, rising ? last[axis] + 1 : corner[axis]));
        if (t < exit) {
          exit = t;
          exit_axis = axis;
        }
      }
      enter = std::max(enter, exit);
      if (enter > query.last()) return;

      // Steps to the finest cell behind that face. Along the other axes it is where the point is, yet
      // neither outside the leaf nor behind the last such cell, whatever the rounding: so every step goes
      // forward and the walk ends.
      for (int axis = 0; axis < 3; ++axis) {
        const double direction = ray.direction[axis];
        if (axis == exit_axis) {
          cell[axis] = direction > 0 ? last[axis] + 1 : corner[axis] - 1;
          if (cell[axis] < 0 || cell[axis] >= space_.cells) return;
        } else if (direction != 0) {
          const std::int32_t index = space_.index_at(axis, ray.origin[axis] + enter * direction);
          cell[axis] = direction > 0 ? std::clamp(index, cell[axis], last[axis])
                                     : std::clamp(index, corner[axis], cell[axis]);
        }
      }
    }
  }

  std::vector<std::pair<std::string, std::uint64_t>> bytes_by_part() const {
    return {{"names", names_.bytes()}, {"references", references_.capacity() * sizeof(std::uint32_t)}};
  }

 private:
  struct Leaf {
    OctreeNode node;
    std::int32_t size;  // in finest cells
  };

  /// The leaf that holds a finest cell.
  template <class Probe>
  Leaf locate(const CellIndex& cell, Probe& probe) const {
    probe.point_location();
    OctreeName name = octree_root_name;
    OctreeNode node = names_.find(name);
    std::int32_t size = space_.cells;
    while (node.is_inner()) {
      probe.inner_step();
      size >>= 1;
      const unsigned child = ((cell.x & size) != 0 ? 1u : 0u) | ((cell.y & size) != 0 ? 2u : 0u) |
                             ((cell.z & size) != 0 ? 4u : 0u);
      name = child_name(name, child);
      node = names_.find(name);
    }
    return {node, size};
  }

  OctreeSpace space_;
  OctreeNames names_;
  MeteredVector<std::uint32_t> references_;
};

}  // namespace raymeter
