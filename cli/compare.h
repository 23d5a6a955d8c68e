#pragma once
#include <string>

#include "accel/registry.h"
#include "cli/selection.h"

namespace raymeter {

/// What `raymeter compare` was asked, as text; defaults as --help says.
struct CompareOptions : Selection {
  std::string baseline = "embree";
  std::string out;
  bool pictures = false;
  unsigned rounds = 5;
  double time_budget = 5;
};

/// Runs the comparison, prints tables to standard output. Returns the exit status: 0 when every exact
/// structure was right, 1 when one was wrong, unexplained or not built, 2 when a scene could not be opened.
/// Throws Error on bad options.
int run_compare(const CompareOptions& options, const Registry& registry);

}  // namespace raymeter
