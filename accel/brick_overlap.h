#pragma once
#include <array>
#include <cstdint>

#include "accel/bricks.h"
#include "scenes/scene.h"

namespace raymeter {

/// A brick's cells against many primitives. Answers yes too often, never no wrongly: a cell counts as met
/// when the primitive meets its box grown by a slack that pays for all roundings here and in
/// BrickNode::plane.
class BrickOverlap {
 public:
  /// Which of sixteen sums are within an interval: bit i + 4 j for low <= a[i] + b[j] <= high. Compiled for
  /// several instruction sets (brick_kernels.h).
  using SumsWithin = std::uint32_t (*)(const std::array<float, 4>& a, const std::array<float, 4>& b,
                                       float low, float high);

  /// `layers`: cells along each axis, 4 or 1. `margin`: what the slack is at least.
  BrickOverlap(const BrickNode& brick, const std::array<int, 3>& layers, double margin,
               SumsWithin sums_within);

  /// The cells that the primitive meets, bit x + 4 y + 16 z.
  std::uint64_t cells_of(const Scene& scene, std::uint32_t primitive) const;

 private:
  std::uint64_t cells_of(const Bounds& box) const;
  std::uint64_t cells_of(const Triangle& triangle) const;

  std::array<int, 3> layers_;
  double margin_;
  SumsWithin sums_within_;
  Vec3d centre_, half_;  // of the brick; of a cell
  std::array<std::array<double, 5>, 3> plane_;
  std::array<std::array<double, 4>, 3> middle_{};  // of cells, from centre_
};

}  // namespace raymeter
