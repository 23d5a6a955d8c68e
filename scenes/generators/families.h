#pragma once
// The families of generated scenes, a file each; scene_generators() lists them.
#include "scenes/generators/generators.h"

namespace raymeter {

/// Random triangles, evenly spread in the unit cube.
SceneGenerator soup_generator();
/// A fractal height field over the unit square.
SceneGenerator terrain_generator();
/// Objects crowded in clusters inside the unit cube, by one knob.
SceneGenerator clusters_generator();

}  // namespace raymeter
