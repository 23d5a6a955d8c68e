#include "cli/pictures.h"

#include <fmt/format.h>

#include <cctype>
#include <chrono>
#include <cstdio>
#include <exception>
#include <system_error>
#include <utility>

#include "reports/picture_file.h"
#include "reports/progress_bar.h"
#include "reports/rendering_pictures.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Rendered render_with(const Spec& spec, const Scene& scene, RenderSettings settings,
                     std::uint64_t memory_limit, const Registry& registry, bool must_count) {
  const Arguments arguments = registry.arguments(spec);
  Rendered result{arguments.canonical(), arguments.brief(), {}, {}};
  ProgressBar bar;
  bar.show(0, 1, "building " + result.brief);
  const auto start = std::chrono::steady_clock::now();
  const auto structure = registry.build(spec, {scene, settings.threads, memory_limit});
  result.build_seconds = seconds_since(start);
  result.stats = structure->stats();
  if (must_count && !structure->counts())
    throw Error(fmt::format("{} can't count what it does: no heat map", result.brief));
  settings.count = structure->counts();
  const auto render_start = std::chrono::steady_clock::now();
  result.rendering = render(scene, *structure, settings, [&](std::size_t done, std::size_t total) {
    bar.show(done, total, "rendering with " + result.brief);
  });
  result.render_seconds = seconds_since(render_start);
  return result;
}

void write_picture(const std::filesystem::path& file, const Scene& scene, const Rendered& rendered) {
  const Rendering& rendering = rendered.rendering;
  const PictureMetadata metadata = rendering_metadata(scene, rendered.spec, rendering);
  if (file.extension() == ".exr")
    write_exr(file, rendering_layers(rendering, metadata));
  else
    write_png(file, colour_picture(rendering), metadata);
}

void write_heat_maps(const std::filesystem::path& file, const Scene& scene,
                     std::span<const WorkMeasure> measures, std::span<const Rendered> all) {
  std::string specs;
  std::vector<HeatMapPanel> panels;
  for (const Rendered& one : all) {
    specs += (specs.empty() ? "" : " ") + one.spec;
    panels.push_back({one.brief, &one.rendering});
  }
  write_png(file, heat_map_sheet(scene.name(), measures, panels),
            rendering_metadata(scene, specs, all[0].rendering));
}

void write_pictures(const std::filesystem::path& folder, const Scene& scene, std::span<const Spec> structures,
                    const RenderSettings& settings, std::uint64_t memory_limit, const Registry& registry) {
  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (status) throw Error(fmt::format("{}: can't make this folder: {}", folder.string(), status.message()));
  std::vector<Rendered> counted;
  bool shown = false;
  for (const Spec& spec : structures) {
    Rendered one;
    try {
      one = render_with(spec, scene, settings, memory_limit, registry, false);
    } catch (const std::exception& error) {
      fmt::print(stderr, "raymeter: no pictures of {}: {}\n", registry.arguments(spec).brief(), error.what());
      continue;
    }
    if (!std::exchange(shown, true)) write_picture(folder / "picture.png", scene, one);
    write_picture(folder / (as_file_name(one.brief) + ".exr"), scene, one);
    if (!one.rendering.work.empty()) counted.push_back(std::move(one));
  }
  if (counted.empty()) return;
  for (const std::string_view name : work_measure_names()) {
    const WorkMeasure measure = work_measure(name);
    write_heat_maps(folder / fmt::format("heat-{}.png", name), scene, {&measure, 1}, counted);
  }
}

std::filesystem::path picture_folder(const std::string& scene, const std::string& scene_hash) {
  return std::filesystem::path("pictures") /
         fmt::format("{}-{}", as_file_name(scene), scene_hash.substr(0, 8));
}

std::string as_file_name(std::string_view text) {
  constexpr std::size_t longest = 120;  // names may have 255 bytes, and others are made of this one
  // A ':' is a '_' where no other '_' is; whatever else is lost is made up for by a hash.
  const auto has = [](std::string_view some, char c) { return some.find(c) != std::string_view::npos; };
  bool ambiguous = text.size() > longest || (has(text, ':') && has(text, '_'));
  std::string name(text.substr(0, longest));
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) || has("._=-", c)) continue;
    ambiguous |= c != ':';
    c = '_';
  }
  if (!ambiguous) return name;
  Hasher hasher;
  hasher.text(text);
  return fmt::format("{}-{:08x}", name, static_cast<std::uint32_t>(hasher.digest()));
}

}  // namespace raymeter
