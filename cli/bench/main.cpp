// The `raymeter_bench` command: a selection of `raymeter compare` under Google Benchmark.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "cli/arguments.h"
#include "cli/bench/benchmarks.h"
#include "cli/selection.h"
#include "harness/environment.h"
#include "scenes/base/error.h"
#include "scenes/base/version.h"
#include "scenes/open_scene.h"

namespace {

constexpr int not_all_right = 1, bad_usage = 2;

constexpr const char* footer =
    "Benchmarks, for every scene and structure:\n"
    "  SCENE/build/STRUCTURE        builds it. Its time is the CPU time of the process\n"
    "  SCENE/RAYS/STRUCTURE/trace   traces all rays of a batch once. Its time is the thread's CPU time\n"
    "So read the column CPU, in JSON cpu_time; with --threads above 1 both go by the clock on the wall,\n"
    "real_time. Rays and the function that traces them are compare's; rays/s, too. Other counters have\n"
    "the names of its columns: hits, steps_per_ray, tests_per_ray, bytes. All answers are checked, while\n"
    "no clock runs. For ratios use compare: it runs two structures by turns, so that a drift of the\n"
    "machine's speed cancels. The warning of a DEBUG library is about Debian's Google Benchmark alone.\n\n"
    "Some flags of Google Benchmark; all are understood, as --flag=value:\n"
    "  --benchmark_list_tests=true                  the names, and no more\n"
    "  --benchmark_filter=REGEX                     only those whose name it matches; -REGEX: the others\n"
    "  --benchmark_min_time=SECONDS                 of each benchmark\n"
    "  --benchmark_repetitions=N                    and their mean, median, standard deviation\n"
    "  --benchmark_enable_random_interleaving=true  repetitions in random order, against drift\n"
    "  --benchmark_format=console|json|csv          to standard output\n"
    "  --benchmark_out=FILE --benchmark_out_format=json|console|csv\n"
    "  --benchmark_counters_tabular=true            counters as columns\n\n"
    "Exit status: 0 every structure but Embree was built and right; 1 one was not; 2 bad usage or input,\n"
    "or nothing to run.\n\n"
    "Examples:\n"
    "  raymeter_bench teapot.nff -s grid -s embree -r primary\n"
    "  raymeter_bench soup:triangles=60000 -s grid:amount=0.5,1,2 -s embree -r primary -r shadow \\\n"
    "    --benchmark_out=grid.json --benchmark_out_format=json\n"
    "  raymeter_bench bunny.ply --benchmark_filter=/build/ --benchmark_repetitions=9";

/// Standard output is the report's alone.
std::vector<raymeter::Scene> open_scenes(const std::vector<std::string>& names) {
  std::vector<raymeter::Scene> scenes;
  for (const std::string& name : names) {
    scenes.push_back(raymeter::open_scene(name));
    for (const std::string& warning : scenes.back().warnings())
      fmt::print(stderr, "raymeter_bench: warning: {}: {}\n", scenes.back().name(), warning);
  }
  return scenes;
}

/// What the numbers were measured with, in the report's context.
void add_context(const std::vector<raymeter::Scene>& scenes) {
  benchmark::AddCustomContext("raymeter_version", RAYMETER_VERSION);
  benchmark::AddCustomContext("environment_id", raymeter::environment_id());
  for (const auto& [name, value] : raymeter::environment())
    if (name == "compiler" || name == "build_type" || name == "build_flags" || name == "build_id" ||
        name == "embree")
      benchmark::AddCustomContext(name, value);
  for (const raymeter::Scene& scene : scenes)
    benchmark::AddCustomContext("scene_hash of " + scene.name(), fmt::format("{:016x}", scene.hash()));
}

/// Gives Google Benchmark its flags. Returns the first that it does not understand, or nothing.
std::string initialize(std::vector<char*> flags) {
  int count = static_cast<int>(flags.size());
  flags.push_back(nullptr);
  benchmark::Initialize(&count, flags.data(), [] {  // for a value that it does not understand
    fmt::print(stderr, "raymeter_bench: bad value of a --benchmark flag (see raymeter_bench --help)\n");
    std::exit(bad_usage);
  });
  return count > 1 ? flags[1] : "";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Builds and traces structures under Google Benchmark: its flags and its JSON, for the tools that\n"
      "read it. What is run is selected as for `raymeter compare`.");
  app.set_version_flag("--version", RAYMETER_VERSION);
  raymeter::Selection selection;
  raymeter::add_selection(app, selection);
  std::vector<std::string> plugins;
  raymeter::add_plugins(app, plugins);
  app.footer(footer);

  std::vector<char*> own{argv[0]}, flags{argv[0]};
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    (argument.starts_with("--benchmark_") || argument.starts_with("--v=") ? flags : own).push_back(argv[i]);
  }
  try {
    app.parse(static_cast<int>(own.size()), own.data());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "raymeter_bench: {} (see raymeter_bench --help)\n", error.what());
    return bad_usage;
  }

  try {
    const std::string unknown = initialize(flags);
    if (!unknown.empty())
      throw raymeter::Error(unknown + ": no such flag, or no such value of it (see raymeter_bench --help)");
    const raymeter::Registry registry = raymeter::registry_with(plugins);
    const raymeter::ComparisonSettings settings = raymeter::settings_of(selection);
    raymeter::check(settings, registry);
    std::vector<raymeter::Scene> scenes = open_scenes(selection.scenes);
    add_context(scenes);
    raymeter::Benchmarks benchmarks(std::move(scenes), registry, settings);
    benchmarks.register_all();
    if (benchmark::RunSpecifiedBenchmarks() == 0) return bad_usage;
    benchmark::Shutdown();
    return benchmarks.all_right() ? 0 : not_all_right;
  } catch (const std::exception& error) {
    fmt::print(stderr, "raymeter_bench: {}\n", error.what());
  }
  return bad_usage;
}
