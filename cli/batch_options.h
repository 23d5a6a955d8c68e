#pragma once
#include <cstdint>
#include <string>

#include "harness/ray_batch.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's name
class App;
}

namespace raymeter {

/// How batches are made, as text; the same for every command that makes any. Defaults as --help says.
struct BatchOptions {
  std::string size = "320x240";
  std::string order = "tiled";
  std::string pixels = "centres";
  std::string camera;
  std::uint64_t seed = 1;
};

/// --size, --order, --pixels, --camera, --seed.
void add_batch_options(CLI::App& command, BatchOptions& o);

/// Throws Error on bad options.
BatchSettings batch_settings(const BatchOptions& options);

}  // namespace raymeter
