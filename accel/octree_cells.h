#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "accel/memory_meter.h"
#include "accel/walk_space.h"
#include "scenes/scene.h"

namespace raymeter {

/// A cell of the finest level an octree may have, counted from the low corner of its cube.
using CellIndex = Vector3<std::int32_t>;

/// The low corner of child k of a node at `corner`; the child is in the node's high half along axis a where
/// bit a of k is set. `size`: of the child.
inline CellIndex child_corner(const CellIndex& corner, unsigned child, std::int32_t size) {
  return {corner.x + (child & 1u ? size : 0), corner.y + (child & 2u ? size : 0),
          corner.z + (child & 4u ? size : 0)};
}

/// The cube that an octree halves. It encloses the scene's walk space and shares its low corner, so that all
/// cells are cubes (as Glassner's), thin scenes are not cut into slices thinner than they are wide, and a
/// flat scene does not lie in the middle plane of its cube.
struct OctreeSpace {
  WalkSpace scene;
  std::int32_t cells = 1;  ///< finest cells along each axis: 2^depth
  double cell = 0;         ///< their edge

  OctreeSpace() = default;
  /// `depth` at most 20. The box must not be empty.
  OctreeSpace(const Bounds& box, int depth) : scene(box), cells(std::int32_t{1} << depth) {
    const Vec3d extent = scene.extent();
    cell = std::ldexp(std::max({extent.x, extent.y, extent.z}), -depth);
    inverse_ = 1 / cell;
  }
  /// The position of the plane between cells index - 1 and index.
  double plane(int axis, std::int32_t index) const { return scene.low[axis] + index * cell; }
  /// The centre of a cube of `size` finest cells.
  Vec3d centre(const CellIndex& corner, std::int32_t size) const {
    const double half = 0.5 * size;
    return scene.low + cell * Vec3d{corner.x + half, corner.y + half, corner.z + half};
  }

  /// The cell that holds a coordinate; the first or the last where the coordinate is outside.
  std::int32_t index_at(int axis, double coordinate) const {
    const double position = (coordinate - scene.low[axis]) * inverse_;
    return static_cast<std::int32_t>(std::clamp(position, 0.0, static_cast<double>(cells - 1)));
  }

 private:
  double inverse_ = 0;
};

struct OctreeNode {
  static constexpr std::uint32_t inner = 0xffffffffu;

  std::uint32_t first = 0;  ///< inner: the first of its eight children in `nodes`; leaf: its first reference
  std::uint32_t count = 0;  ///< leaf: how many references; `inner` marks an inner node

  bool is_inner() const { return count == inner; }
};

/// An octree as it is built: nodes with the eight children of each side by side, the root first.
struct OctreeCells {
  explicit OctreeCells(MemoryMeter& meter)
      : nodes(MeteredAllocator<OctreeNode>(meter)), references(MeteredAllocator<std::uint32_t>(meter)) {}

  OctreeSpace space;
  MeteredVector<OctreeNode> nodes;          ///< none when the scene is empty
  MeteredVector<std::uint32_t> references;  ///< the primitives of leaf after leaf
  int depth = 0;                            ///< levels below the root that exist
  std::uint64_t inner_nodes = 0, leaves = 0, empty_leaves = 0;
  std::string note;  ///< what kept the tree from being as the parameters ask
};

/// Splits a cell in eight while it holds more than `leaf` primitives and is less than `depth` levels below
/// the root (Glassner, "Space Subdivision for Fast Ray Tracing", 1984), level by level. A cell holds a
/// primitive when its box, grown by the margin of walk_space.h, meets the primitive. A cell stays whole where
/// all eight children would hold all of its primitives, and where the tree would have more than 32 references
/// or nodes for each primitive, and 65,536 besides: `note` says so. Throws MemoryLimitExceeded.
OctreeCells build_octree_cells(const Scene& scene, std::uint32_t leaf, int depth, MemoryMeter& meter);

}  // namespace raymeter
