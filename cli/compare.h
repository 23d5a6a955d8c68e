#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "accel/registry.h"
#include "cli/batch_options.h"

namespace raymeter {

/// What `raymeter compare` was asked, as text; defaults as --help says.
struct CompareOptions {
  std::vector<std::string> scenes;
  std::vector<std::string> structures;
  std::vector<std::string> rays;
  std::vector<std::string> ray_files;
  std::string baseline = "embree";
  std::string out;
  bool pictures = false;
  BatchOptions batches;
  unsigned rounds = 5;
  double time_budget = 5;
  unsigned threads = 1;
  std::uint64_t memory_limit = 4'000'000'000;
};

/// Runs the comparison, prints tables to standard output. Returns the exit status: 0 when every exact
/// structure was right, 1 when one was wrong, unexplained or not built, 2 when a scene could not be opened.
/// Throws Error on bad options.
int run_compare(const CompareOptions& options, const Registry& registry);

}  // namespace raymeter
