#include "accel/plugin.h"
#include "small_bvh.h"

RAYMETER_PLUGIN(register_small_bvh);
