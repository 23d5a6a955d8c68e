#pragma once
#include <string>

#include "accel/registry.h"
#include "cli/batch_options.h"

namespace raymeter {

/// What `raymeter rays` was asked, as text; defaults as --help says.
struct RaysOptions {
  std::string scene;
  std::string kind = "primary";
  std::string out;
  BatchOptions batches;
};

/// Makes the batch that `compare` makes with the same options, writes it to a file and says so on standard
/// output. Returns the exit status: 0, or 1 when the hits that the rays start from are in doubt. Throws Error
/// on bad options and input.
int run_rays(const RaysOptions& options, const Registry& registry);

}  // namespace raymeter
