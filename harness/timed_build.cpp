#include "harness/timed_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <exception>
#include <vector>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

double process_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Built build_once(const Registry& registry, const Spec& spec, const BuildInput& input) {
  Built built;
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = process_cpu_seconds();
  try {
    built.structure = registry.build(spec, input);
  } catch (const std::exception& error) {
    built.failure = error.what();
    return built;
  }
  built.seconds = input.threads == 1
                      ? process_cpu_seconds() - cpu
                      : std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  built.stats = built.structure->stats();
  return built;
}

Built build_timed(const Registry& registry, const Spec& spec, const BuildInput& input) {
  Built built;
  std::vector<double> seconds;
  double total = 0;
  do {
    built = {};  // never two of them at once
    built = build_once(registry, spec, input);
    seconds.push_back(built.seconds);
    total += built.seconds;
  } while (built.structure && seconds.size() < 5 && total < 0.2);
  built.seconds = median(seconds);
  built.builds = static_cast<unsigned>(seconds.size());
  built.range = {std::ranges::min(seconds), std::ranges::max(seconds)};
  return built;
}

std::unique_ptr<Structure> build_reference(const Registry& registry, const BuildInput& input) {
  std::string failures;
  for (const char* name : {"counted-bvh", "grid", "brute-force"}) {
    Built built = build_once(registry, Spec{name, {}}, input);
    if (built.structure) return std::move(built.structure);
    failures += fmt::format("; {}: {}", name, built.failure);
  }
  throw Error(fmt::format("{}: no structure could be built to take reference hits from{}", input.scene.name(),
                          failures));
}

}  // namespace raymeter
