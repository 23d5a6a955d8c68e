#include "cli/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "harness/comparison.h"
#include "harness/environment.h"
#include "reports/comparison_recorder.h"
#include "reports/comparison_table.h"
#include "reports/record_files.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

constexpr std::uint32_t max_side = 65536;

/// "320x240".
PictureSize parse_size(const std::string& text) {
  PictureSize size;
  const char* end = text.data() + text.size();
  const auto [after_width, width_status] = std::from_chars(text.data(), end, size.width);
  if (width_status == std::errc() && after_width != end && *after_width == 'x') {
    const auto [after_height, height_status] = std::from_chars(after_width + 1, end, size.height);
    if (height_status == std::errc() && after_height == end && size.width > 0 && size.height > 0 &&
        size.width <= max_side && size.height <= max_side)
      return size;
  }
  throw Error(fmt::format("--size {}: expected WIDTHxHEIGHT in pixels, each 1..{}", text, max_side));
}

/// "from=0x-5x2:at=0x0x0:up=0x0x1:angle=45".
Camera parse_camera(const std::string& text) {
  const std::vector<Parameter> table{
      {"from", ParameterType::vector, "", "", -3e38, 3e38},
      {"at", ParameterType::vector, "", "", -3e38, 3e38},
      {"up", ParameterType::vector, "0x1x0", "", -3e38, 3e38},
      {"angle", ParameterType::number, "45", "", 0.001, 179.9},
  };
  const Arguments arguments(parse_spec("camera:" + text), table);
  const auto vector = [&](const char* name) {
    if (arguments.text(name).empty()) throw Error(fmt::format("--camera {}: '{}' is missing", text, name));
    const auto v = arguments.vector(name);
    if (v.size() != 3)
      throw Error(fmt::format("--camera {}: '{}' needs three numbers, as 0x-5x2", text, name));
    return to_float({v[0], v[1], v[2]});
  };
  Camera camera{vector("from"), vector("at"), vector("up"), static_cast<float>(arguments.number("angle"))};
  return camera;
}

RayOrder parse_order(const std::string& text) {
  return text == "scanline" ? RayOrder::scanline : text == "shuffled" ? RayOrder::shuffled : RayOrder::tiled;
}

std::vector<Spec> parse_all(const std::vector<std::string>& texts) {
  std::vector<Spec> specs;
  for (const std::string& text : texts)
    for (Spec& spec : parse_specs(text)) specs.push_back(std::move(spec));
  return specs;
}

ComparisonSettings settings_of(const CompareOptions& options) {
  ComparisonSettings settings;
  settings.structures = parse_all(options.structures);
  settings.ray_kinds = parse_all(options.rays);
  settings.baseline = parse_spec(options.baseline);
  settings.batches.order = parse_order(options.order);
  settings.batches.size = parse_size(options.size);
  settings.batches.size.pixel_corners = options.pixels == "corners";
  settings.batches.seed = options.seed;
  if (!options.camera.empty()) settings.batches.camera = parse_camera(options.camera);
  settings.race.rounds = options.rounds;
  settings.race.threads = options.threads;
  settings.race.time_budget = options.time_budget;
  // Both sides of all rounds fit a budget that is shorter than usual rounds.
  settings.race.min_round_seconds =
      std::min(settings.race.min_round_seconds, options.time_budget / (2 * options.rounds));
  settings.memory_limit = options.memory_limit;
  return settings;
}

}  // namespace

int run_compare(const CompareOptions& options, const Registry& registry) {
  const ComparisonSettings settings = settings_of(options);
  check(settings, registry);

  const std::filesystem::path folder = options.out;
  std::optional<RecordLog> log;
  if (!options.out.empty()) {
    std::error_code status;
    std::filesystem::create_directories(folder, status);
    if (status) throw Error(fmt::format("{}: can't make this folder: {}", options.out, status.message()));
    log.emplace(folder / "records.jsonl");
    write_environment(folder / "environment.json", environment_id(), environment());
  }

  ComparisonRecorder recorder(registry, log ? &*log : nullptr);
  bool all_opened = true;
  for (const std::string& name : options.scenes) {
    try {
      const Scene scene = open_scene(name);
      for (const std::string& warning : scene.warnings())
        fmt::print(stderr, "raymeter: warning: {}: {}\n", scene.name(), warning);
      compare_structures(scene, registry, settings, recorder);
      fmt::print("{}\n", comparison_table(recorder.take_records(), registry));
      std::fflush(stdout);
      if (log) write_csv(folder / "records.csv", log->records());
    } catch (const Error& error) {
      // One bad scene does not keep the others from being compared.
      recorder.take_records();
      fmt::print(stderr, "raymeter: {}\n", error.what());
      all_opened = false;
    }
  }
  if (log) fmt::print("{} records in {}\n", log->records().size(), (folder / "records.csv").string());
  return !all_opened ? 2 : recorder.all_right() ? 0 : 1;
}

}  // namespace raymeter
