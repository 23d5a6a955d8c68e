#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "cli/batch_options.h"
#include "harness/comparison_settings.h"

namespace raymeter {

/// What is to be run, as text: which structures, on which rays, in which scenes. Defaults as --help says.
struct Selection {
  std::vector<std::string> scenes;
  std::vector<std::string> structures;
  std::vector<std::string> rays;
  std::vector<std::string> ray_files;
  BatchOptions batches;
  unsigned threads = 1;
  std::uint64_t memory_limit = 4'000'000'000;
};

/// The scenes, -s, -r, --ray-file, those of add_batch_options, --threads, --memory-limit.
void add_selection(CLI::App& command, Selection& o);

/// Everything in it but the scenes. Throws Error on bad options.
ComparisonSettings settings_of(const Selection& selection);

}  // namespace raymeter
