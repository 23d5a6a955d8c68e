#pragma once
#include "accel/brick_overlap.h"
#include "accel/bricks.h"
#include "accel/cell_lists.h"
#include "scenes/scene.h"

namespace raymeter {

/// How bricks are made.
struct BrickOptions {
  /// A node of more primitives is split, as far as the limits allow; 0: where it seems to pay.
  std::uint32_t leaf = 0;
  BrickOverlap::SumsWithin sums_within = nullptr;
};

/// Fills roots, nodes, words and depth below a grid whose cells list their primitives. Throws Error when a
/// word's place does not fit 32 bits, and MemoryLimitExceeded.
void build_bricks(const Scene& scene, const CellLists& lists, const BrickOptions& options, MemoryMeter& meter,
                  Bricks& bricks);

}  // namespace raymeter
