#pragma once
// The families of generated scenes, a file each; scene_generators() lists them.
#include <vector>

#include "scenes/generators/generators.h"

namespace raymeter {

/// Random triangles, evenly spread in the unit cube.
SceneGenerator soup_generator();
/// A fractal height field over the unit square.
SceneGenerator terrain_generator();
/// Objects crowded in clusters inside the unit cube, by one knob.
SceneGenerator clusters_generator();
/// The Standard Procedural Databases (scenes/generators/spd/), of any size.
std::vector<SceneGenerator> spd_generators();

// With one knob each, for studies.
SceneGenerator crowding_generator();    ///< confined to a part of the box
SceneGenerator sizes_generator();       ///< spread of sizes
SceneGenerator slivers_generator();     ///< aspect ratio
SceneGenerator stadium_generator();     ///< a small object on a wide ground
SceneGenerator two_scales_generator();  ///< two soups of different scale

// In place of the three scenes, lost to us, of the paper that introduced the heuristic grid (Sakai, Watanabe,
// Miyoshi, Fukuda, "A Method for Accelerating Ray Tracing by Optimizing Regular Spatial Subdivision"): as
// many shapes of the same kinds, and within a few percent as many rays in a Whitted rendering at 320x240.
SceneGenerator paper_still_life_generator();  ///< depth 4: 274,255 rays
SceneGenerator paper_hall_generator();        ///< depth 1: 137,353 rays
SceneGenerator paper_chess_generator();       ///< depth 2: 157,928 rays

}  // namespace raymeter
