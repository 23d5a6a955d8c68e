#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "accel/registry.h"

namespace raymeter {

/// What `raymeter render` was asked, as text; defaults as --help says.
struct RenderOptions {
  std::string scene;
  std::string structure = "counted-bvh";
  std::vector<std::string> compare;
  std::string out;                ///< empty: no picture
  std::vector<std::string> heat;  ///< empty: the picture itself
  std::string size;               ///< empty: the scene's
  std::string pixels = "centres";
  std::string rays = "all";
  std::string camera;
  unsigned depth = 5;
  unsigned threads = 0;  ///< 0: all CPUs
  std::uint64_t memory_limit = 4'000'000'000;
};

/// Renders, writes the picture, and prints how many rays were cast. Returns the exit status 0. Throws Error.
int run_render(const RenderOptions& options, const Registry& registry);

}  // namespace raymeter
