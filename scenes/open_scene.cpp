#include "scenes/open_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "scenes/base/error.h"
#include "scenes/generators/generators.h"
#include "scenes/readers/readers.h"

namespace raymeter {
namespace {

using Reader = SceneData (*)(const std::filesystem::path&);

Reader reader_for(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (extension == ".nff") return read_nff;
  if (extension == ".obj") return read_obj;
  if (extension == ".ply") return read_ply;
  if (extension == ".stl") return read_stl;
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
  return nullptr;
}

SceneData read_file(const std::filesystem::path& file) {
  std::error_code is_folder;
  if (std::filesystem::is_directory(file, is_folder)) throw Error(fmt::format("{}: a folder", file.string()));
  const Reader read = reader_for(file);
  if (!read)
    throw Error(
        fmt::format("{}: unknown kind of file; known are .nff .obj .ply .stl .gltf .glb", file.string()));
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw Error(fmt::format("{}: no such file", file.string()));
  if (!std::filesystem::is_regular_file(file, status))
    throw Error(fmt::format("{}: not a file", file.string()));
  SceneData data = read(file);
  if (data.name.empty()) data.name = file.filename().string();
  return data;
}

SceneData generate(std::string_view text) {
  const Spec spec = parse_spec(text);
  std::vector<std::string_view> names;
  for (const SceneGenerator& generator : scene_generators()) {
    if (generator.name == spec.name) {
      const Arguments arguments(spec, generator.parameters);
      SceneData data = generator.make(arguments);
      data.name = arguments.canonical();
      return data;
    }
    names.push_back(generator.name);
  }
  throw Error(
      fmt::format("no scene '{}'; a file's name ends in .nff .obj .ply .stl .gltf or .glb, and there are "
                  "the generated scenes {}",
                  spec.name, fmt::join(names, ", ")));
}

}  // namespace

Scene open_scene(std::string_view name_or_path) {
  const bool is_path = name_or_path.starts_with('.') || name_or_path.starts_with('/') ||
                       reader_for(std::filesystem::path(name_or_path)) != nullptr;
  return Scene(is_path ? read_file(std::filesystem::path(name_or_path)) : generate(name_or_path));
}

}  // namespace raymeter
