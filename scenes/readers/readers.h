#pragma once
#include <filesystem>

#include "scenes/scene.h"

namespace raymeter {

/// Each reads one file whole or throws an Error that names the file and the line or byte offset. None
/// allocates more than a small multiple of the file's size, whatever counts the file claims; but a glTF file
/// may place one mesh in many nodes, and is read up to 2^24 vertices and as many triangles in all.

/// Neutral File Format (Haines 1987), as its document says; see nff.cpp for its corners.
SceneData read_nff(const std::filesystem::path& file);
/// Wavefront OBJ: v, vn, f (any polygon, any slash form, relative indices, continuation lines).
SceneData read_obj(const std::filesystem::path& file);
/// PLY 1.0: ascii, binary little and big endian, any scalar types, extra elements and properties skipped.
SceneData read_ply(const std::filesystem::path& file);
/// STL: ascii and binary, told apart by size and content, not by the word "solid".
SceneData read_stl(const std::filesystem::path& file);
/// glTF 2.0: .gltf with files or data URIs, .glb; triangles, strips and fans, node transforms.
SceneData read_gltf(const std::filesystem::path& file);

}  // namespace raymeter
