// A plug-in whose structure has the name of one of ours.
#include "accel/plugin.h"

namespace {

void register_structures(raymeter::Registry& registry) {
  registry.add({.name = "grid", .build = {}});
}

}  // namespace

RAYMETER_PLUGIN(register_structures);
