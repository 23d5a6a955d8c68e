#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/rendering.h"
#include "reports/heat_map.h"
#include "scenes/scene.h"

namespace raymeter {

/// One structure's rendering of a scene, and how long it took.
struct Rendered {
  std::string spec, brief;  ///< canonical; without defaults
  StructureStats stats;
  Rendering rendering;  ///< counted where the structure can
  double build_seconds = 0, render_seconds = 0;
};

/// Builds a structure and renders with it, with a progress bar on a terminal. Throws what building throws,
/// and Error where it `must_count` and can't.
Rendered render_with(const Spec& spec, const Scene& scene, RenderSettings settings,
                     std::uint64_t memory_limit, const Registry& registry, bool must_count);

/// Writes what was seen: .png the picture, .exr all layers.
void write_picture(const std::filesystem::path& file, const Scene& scene, const Rendered& rendered);
/// Writes the heat maps of structures side by side as PNG.
void write_heat_maps(const std::filesystem::path& file, const Scene& scene,
                     std::span<const WorkMeasure> measures, std::span<const Rendered> all);

/// Renders a scene with each of the structures and writes into `folder`, which is made: picture.png, for each
/// measure of work a heat-MEASURE.png of those that count, and for each structure an .exr named by its spec.
/// A structure that can't be built is left out; the reason goes to standard error.
void write_pictures(const std::filesystem::path& folder, const Scene& scene, std::span<const Spec> structures,
                    const RenderSettings& settings, std::uint64_t memory_limit, const Registry& registry);

/// Where in a run's folder the pictures of a scene are: scenes of different folders may have the same name.
/// `scene_hash` as records hold it.
std::filesystem::path picture_folder(const std::string& scene, const std::string& scene_hash);

/// A text as part of a file's name: letters, digits, '.', '-', '_' and '=' stay. Ends with a hash of the text
/// where another one might have the same name.
std::string as_file_name(std::string_view text);

}  // namespace raymeter
