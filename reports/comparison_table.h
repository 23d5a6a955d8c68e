#pragma once
#include <span>
#include <string>

#include "accel/registry.h"
#include "harness/record.h"

namespace raymeter {

/// The table that `compare` prints of one scene's records, which come batch by batch or structure by
/// structure: at most 100 columns, one block a batch, one line a structure, and below it in words whatever a
/// number alone would hide: differences by class, clamps, failures, noise.
std::string comparison_table(std::span<const Record> records, const Registry& registry);

}  // namespace raymeter
