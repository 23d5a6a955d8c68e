// A plug-in that registers nothing.
#include "accel/plugin.h"

namespace {

void register_structures(raymeter::Registry& /*registry*/) {}

}  // namespace

RAYMETER_PLUGIN(register_structures);
