#pragma once
// The families of generated scenes, a file each; scene_generators() lists them.
#include "scenes/generators/generators.h"

namespace raymeter {

SceneGenerator soup_generator();

}  // namespace raymeter
