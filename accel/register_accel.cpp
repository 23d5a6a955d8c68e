#include "accel/registry.h"

namespace raymeter {

void register_accel(Registry&) {}

}  // namespace raymeter
