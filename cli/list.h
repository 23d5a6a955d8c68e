#pragma once
#include <string_view>

#include "accel/registry.h"

namespace raymeter {

/// Prints what there is of `what`: scenes, structures, rays or columns, with parameters and meanings.
void run_list(std::string_view what, const Registry& registry);

}  // namespace raymeter
