#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "accel/bricks.h"
#include "scenes/geometry/bounds.h"
#include "scenes/scene.h"

namespace raymeter {

/// Triangles, one in each column of nine rows of floats: corners a, b and c, of each x, y and z. Whole
/// vectors are read: what lies beyond the last column, up to a multiple of widest_vector, does not matter.
struct TriangleColumns {
  const float* rows = nullptr;
  std::size_t stride = 0;  ///< from row to row
  std::size_t count = 0;
};

/// A brick and how it is cut. No primitive given to the functions below may reach farther than 2^40 `margin`
/// from it.
struct CutBrick {
  BrickNode node;
  std::array<int, 3> layers{4, 4, 4};  ///< cells along each axis; where there is one, all of the node's size
  double margin = 0;

  /// How far beyond its planes a cell counts as met, at least: see RayPacket.
  double slack(int axis) const {
    return margin +
           0x1p-20 * (node.plane(axis, layers[static_cast<std::size_t>(axis)]) - node.plane(axis, 0));
  }
};

/// A brick's cells against many triangles, for one instruction set; the answers are equal for all. They say
/// yes too often, never no wrongly: a cell counts as met when the triangle meets its box grown by the slack.
struct BrickOverlap {
  std::string_view isa;
  /// The box of one triangle or more.
  Bounds (*bounds_of)(const TriangleColumns& triangles);
  /// Of each triangle the cells that it meets, bit x + 4 y + 16 z.
  void (*cells_of)(const CutBrick& brick, const TriangleColumns& triangles, std::uint64_t* cells);
  /// Adds to counts[i] the number of masks that have bit i.
  void (*count_bits)(std::span<const std::uint64_t> masks, std::array<std::uint32_t, 64>& counts);
};

/// For the instruction sets of this CPU, the widest first.
std::span<const BrickOverlap> brick_overlaps();

/// The cells that a primitive meets which is no triangle.
std::uint64_t cells_of_other(const CutBrick& brick, const Scene& scene, std::uint32_t primitive);

}  // namespace raymeter
