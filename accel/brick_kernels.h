#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "accel/bricks.h"
#include "accel/structure.h"
#include "scenes/scene.h"

namespace raymeter {

/// What is compiled once for each instruction set, and chosen when a structure is built.
struct BrickKernels {
  const char* isa;
  void (*trace_closest)(const Bricks&, const Scene&, const BatchView&, std::span<Hit>);
  void (*trace_any)(const Bricks&, const Scene&, const BatchView&, std::span<std::uint8_t>);
  void (*count_closest)(const Bricks&, const Scene&, const BatchView&, std::span<Hit>,
                        std::span<RayCounters>);
  void (*count_any)(const Bricks&, const Scene&, const BatchView&, std::span<std::uint8_t>,
                    std::span<RayCounters>);
};

/// Those that this CPU can run, the widest first.
std::vector<const BrickKernels*> brick_kernels();

}  // namespace raymeter
