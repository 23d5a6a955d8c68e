// A plug-in whose registration throws after it has registered something, and not even a std::exception when
// RAYMETER_TEST_THROWS is set.
#include <cstdlib>
#include <stdexcept>

#include "accel/plugin.h"

namespace {

void register_structures(raymeter::Registry& registry) {
  registry.add({.name = "half", .build = {}});
  if (std::getenv("RAYMETER_TEST_THROWS")) throw 42;  // NOLINT(misc-throw-by-value-catch-by-reference)
  throw std::runtime_error("no licence found");
}

}  // namespace

RAYMETER_PLUGIN(register_structures);
