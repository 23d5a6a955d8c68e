#include "cli/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "cli/pictures.h"
#include "cli/report.h"
#include "harness/comparison.h"
#include "harness/environment.h"
#include "harness/ray_kinds.h"
#include "reports/comparison_recorder.h"
#include "reports/comparison_table.h"
#include "reports/record_files.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

ComparisonSettings comparison_settings(const CompareOptions& options) {
  ComparisonSettings settings = settings_of(options);
  settings.baseline = parse_spec(options.baseline);
  settings.race.rounds = options.rounds;
  settings.race.time_budget = options.time_budget;
  // Both sides of all rounds fit a budget that is shorter than usual rounds.
  settings.race.min_round_seconds =
      std::min(settings.race.min_round_seconds, options.time_budget / (2 * options.rounds));
  return settings;
}

/// What the run's pictures show: the rays of `whitted` in it, else those of its default depth.
RenderSettings picture_settings(const ComparisonSettings& settings) {
  RenderSettings pictures{.size = settings.batches.size, .camera = settings.batches.camera};
  pictures.threads = std::max(1u, std::thread::hardware_concurrency());  // nothing is timed
  for (const Spec& kind : settings.ray_kinds)
    if (kind.name == "whitted") pictures.depth = static_cast<unsigned>(ray_arguments(kind).integer("depth"));
  return pictures;
}

}  // namespace

int run_compare(const CompareOptions& options, const Registry& registry) {
  const ComparisonSettings settings = comparison_settings(options);
  check(settings, registry);
  if (options.pictures && options.out.empty())
    throw Error("--pictures needs a folder to write to: --out DIR");
  if (options.pictures) check_picture(settings.batches.size);

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
      if (options.pictures)
        write_pictures(folder / picture_folder(scene.name(), fmt::format("{:016x}", scene.hash())), scene,
                       structures_of(settings, registry), picture_settings(settings), settings.memory_limit,
                       registry);
    } catch (const Error& error) {
      // One bad scene does not keep the others from being compared.
      recorder.take_records();
      fmt::print(stderr, "raymeter: {}\n", error.what());
      all_opened = false;
    }
  }
  if (options.pictures) fmt::print("pictures in {}\n", (folder / "pictures").string());
  if (log) {
    write_report_page(folder, registry);
    fmt::print("{} records and report.html in {}\n", log->records().size(), folder.string());
  }
  return !all_opened ? 2 : recorder.all_right() ? 0 : 1;
}

}  // namespace raymeter
