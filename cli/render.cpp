#include "cli/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "cli/arguments.h"
#include "cli/pictures.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

enum class PictureKind : std::uint8_t { none, picture, heat };

PictureKind picture_kind(const RenderOptions& options) {
  for (const std::string& measure : options.heat) work_measure(measure);
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
  return PictureKind::picture;
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
  if (const StructureStats& stats = one.stats; stats.cells > 0)
    fmt::print("  {} cells, {} of them empty, {} references, {} inner nodes\n", stats.cells,
               stats.empty_cells, stats.references, stats.inner_nodes);
  if (!one.stats.note.empty()) fmt::print("  {}\n", one.stats.note);
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
    all.push_back(
        render_with(spec, scene, settings, options.memory_limit, registry, kind == PictureKind::heat));
  if (kind == PictureKind::heat) {
    std::vector<WorkMeasure> measures;
    for (const std::string& name : options.heat) measures.push_back(work_measure(name));
    write_heat_maps(options.out, scene, measures, all);
  } else if (kind == PictureKind::picture) {
    write_picture(options.out, scene, all[0]);
  }

  const Rendering& first = all[0].rendering;
  fmt::print("{}  {}x{}, depth {}, ray hash {:016x}\n", scene.name(), first.columns, first.rows,
             options.depth, first.ray_hash);
  print_rays(first);
  for (const Rendered& one : all) print_work(one, options.rays == "primary");
  if (kind != PictureKind::none) fmt::print("{}\n", options.out);
  return 0;
}

}  // namespace raymeter
