#pragma once
#include <string_view>

#include "scenes/scene.h"

namespace raymeter {

/// Opens a scene by path (`./a.nff`, `mesh.ply`, ...) or makes one by name (`soup:triangles=60000:seed=7`).
/// An argument is a path if it begins with . or / or ends in a known extension (.nff .obj .ply .stl .gltf
/// .glb), else a name. Throws Error: one line with file and line or byte offset, or what names there are.
Scene open_scene(std::string_view name_or_path);

}  // namespace raymeter
