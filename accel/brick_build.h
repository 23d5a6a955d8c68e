#pragma once
#include "accel/brick_overlap.h"
#include "accel/bricks.h"
#include "scenes/scene.h"

namespace raymeter {

/// How bricks are made.
struct BrickOptions {
  /// A node of more primitives is split, as far as the limits allow; 0: where it seems to pay.
  std::uint32_t leaf = 0;
  const BrickOverlap* overlap = nullptr;
};

/// Fills roots, nodes, words and depth below the grid. Throws Error when a word's place does not fit 32 bits,
/// and MemoryLimitExceeded.
void build_bricks(const Scene& scene, const BrickOptions& options, MemoryMeter& meter, Bricks& bricks);

}  // namespace raymeter
