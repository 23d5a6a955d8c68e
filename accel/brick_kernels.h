#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "accel/bricks.h"
#include "accel/structure.h"
#include "scenes/scene.h"

namespace raymeter {

/// Whether neighbouring rays that go the same way are traced together.
enum class PacketUse : std::uint8_t { never, where_worth_while, always };

/// What is compiled once for each instruction set, and chosen when a structure is built.
struct BrickKernels {
  const char* isa;
  void (*trace_closest)(const Bricks&, const Scene&, const BatchView&, PacketUse, std::span<Hit>);
  void (*trace_any)(const Bricks&, const Scene&, const BatchView&, PacketUse, std::span<std::uint8_t>);
  void (*count_closest)(const Bricks&, const Scene&, const BatchView&, PacketUse, std::span<Hit>,
                        std::span<RayCounters>);
  void (*count_any)(const Bricks&, const Scene&, const BatchView&, PacketUse, std::span<std::uint8_t>,
                    std::span<RayCounters>);
};

/// Those that this CPU can run, the widest first.
std::vector<const BrickKernels*> brick_kernels();

}  // namespace raymeter
