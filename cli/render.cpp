#include "cli/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "cli/arguments.h"
#include "harness/rendering.h"
#include "reports/heat_map.h"
#include "reports/picture_file.h"
#include "reports/progress_bar.h"
#include "reports/rendering_pictures.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

enum class PictureKind : std::uint8_t { none, png, exr, heat };

PictureKind picture_kind(const RenderOptions& options) {
  if (!options.heat.empty()) work_measure(options.heat);
  const std::string extension = std::filesystem::path(options.out).extension().string();
  if (options.out.empty()) {
    if (!options.heat.empty()) throw Error("--heat needs a file to write to: -o FILE.png");
    return PictureKind::none;
  }
  const std::filesystem::path folder = std::filesystem::path(options.out).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    throw Error(fmt::format("-o {}: there is no folder {}", options.out, folder.string()));
  if (extension != ".png" && extension != ".exr")
    throw Error(fmt::format("-o {}: a picture's name ends in .png or .exr", options.out));
  if (!options.heat.empty()) {
    if (extension != ".png") throw Error("--heat makes a PNG; an EXR file has all counts as layers anyway");
    return PictureKind::heat;
  }
  return extension == ".png" ? PictureKind::png : PictureKind::exr;
}

RenderSettings settings_of(const RenderOptions& options, const Scene& scene) {
  RenderSettings settings;
  if (!options.camera.empty()) settings.camera = parse_camera(options.camera);
  settings.size = {scene.camera().width, scene.camera().height};
  if (!options.size.empty()) settings.size = parse_size(options.size);
  settings.size.pixel_corners = options.pixels == "corners";
  settings.depth = options.depth;
  settings.threads = options.threads ? options.threads : std::max(1u, std::thread::hardware_concurrency());
  settings.primary_only = options.rays == "primary";
  return settings;
}

/// One structure's rendering, and how long it took.
struct Rendered {
  std::string spec, brief;
  Rendering rendering;
  double build_seconds = 0, render_seconds = 0;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Rendered render_with(const Spec& spec, const Scene& scene, const RenderOptions& options,
                     RenderSettings settings, const Registry& registry, bool must_count) {
  const Arguments arguments = registry.arguments(spec);
  Rendered result{arguments.canonical(), arguments.brief(), {}};
  ProgressBar bar;
  bar.show(0, 1, "building " + result.brief);
  const auto start = std::chrono::steady_clock::now();
  const auto structure = registry.build(spec, {scene, settings.threads, options.memory_limit});
  result.build_seconds = seconds_since(start);
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

void write_picture(const RenderOptions& options, PictureKind kind, const Scene& scene,
                   const std::vector<Rendered>& all) {
  const Rendered& first = all[0];
  std::string specs = first.spec;
  for (std::size_t i = 1; i < all.size(); ++i) specs += " " + all[i].spec;
  const PictureMetadata metadata = rendering_metadata(scene, specs, first.rendering);
  if (kind == PictureKind::png) write_png(options.out, colour_picture(first.rendering), metadata);
  if (kind == PictureKind::exr) write_exr(options.out, rendering_layers(first.rendering, metadata));
  if (kind != PictureKind::heat) return;
  std::vector<HeatMapPanel> panels;
  for (const Rendered& one : all) panels.push_back({one.brief, &one.rendering});
  write_png(options.out, heat_map_sheet(scene.name(), work_measure(options.heat), panels), metadata);
}

void print_rays(const Rendering& rendering) {
  fmt::print("  {:<11} {:>5} {:>12} {:>12}\n", "rays", "depth", "cast", "hits");
  const auto line = [](const RayCount& count, const std::string& depth) {
    fmt::print("  {:<11} {:>5} {:>12} {:>12}\n", name_of(count.purpose), depth, count.rays, count.hits);
  };
  for (const RayCount& count : rendering.rays) line(count, fmt::format("{}", count.depth));
  for (const RayPurpose purpose : {RayPurpose::reflection, RayPurpose::refraction, RayPurpose::shadow})
    if (const RayCount sum = rendering.total(purpose); sum.rays > 0) line(sum, "all");
}

void print_work(const Rendered& one, bool primary_only) {
  fmt::print("{}: built in {:.3g} s, rendered in {:.3g} s{}\n", one.spec, one.build_seconds,
             one.render_seconds, one.rendering.work.empty() ? "" : " with counting");
  if (one.rendering.work.empty()) return;
  PixelWork sum;
  for (const PixelWork& work : one.rendering.work) {
    sum.steps += work.steps;
    sum.empty_cell_steps += work.empty_cell_steps;
    sum.tests += work.tests;
    sum.distinct_tests += work.distinct_tests;
  }
  std::uint64_t rays = 0;
  for (const RayCount& count : one.rendering.rays)
    if (!primary_only || count.purpose == RayPurpose::primary) rays += count.rays;
  const auto per_ray = [&](std::uint64_t work) { return double(work) / double(rays); };
  fmt::print("  per {}: {:.4g} steps, {:.4g} empty-steps, {:.4g} tests, {:.4g} distinct-tests\n",
             primary_only ? "primary ray" : "ray", per_ray(sum.steps), per_ray(sum.empty_cell_steps),
             per_ray(sum.tests), per_ray(sum.distinct_tests));
}

}  // namespace

int run_render(const RenderOptions& options, const Registry& registry) {
  // Whatever is wrong with the arguments is said before the scene is opened.
  const PictureKind kind = picture_kind(options);
  std::vector<Spec> specs{parse_spec(options.structure)};
  for (const std::string& text : options.compare)
    for (Spec& spec : parse_specs(text)) specs.push_back(std::move(spec));
  if (specs.size() > 1 && kind != PictureKind::heat)
    throw Error("--compare lays heat maps side by side: say which by --heat");
  for (const Spec& spec : specs) registry.arguments(spec);
  if (!options.size.empty()) parse_size(options.size);

  const Scene scene = open_scene(options.scene);
  for (const std::string& warning : scene.warnings())
    fmt::print(stderr, "raymeter: warning: {}: {}\n", scene.name(), warning);
  const RenderSettings settings = settings_of(options, scene);
  check_picture(settings.size);
  std::vector<Rendered> all;
  for (const Spec& spec : specs)
    all.push_back(render_with(spec, scene, options, settings, registry, kind == PictureKind::heat));
  if (kind != PictureKind::none) write_picture(options, kind, scene, all);

  const Rendering& first = all[0].rendering;
  fmt::print("{}  {}x{}, depth {}, ray hash {:016x}\n", scene.name(), first.columns, first.rows,
             options.depth, first.ray_hash);
  print_rays(first);
  for (const Rendered& one : all) print_work(one, options.rays == "primary");
  if (kind != PictureKind::none) fmt::print("{}\n", options.out);
  return 0;
}

}  // namespace raymeter
