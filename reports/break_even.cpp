#include "reports/break_even.h"

#include <fmt/format.h>

#include <limits>

namespace raymeter {
namespace {

/// Where two costs are equal; infinity or below 0 where they never are.
double crossing(const Cost& a, const Cost& b) {
  const double slopes = 1 / b.rays_per_s - 1 / a.rays_per_s;
  return slopes == 0 ? std::numeric_limits<double>::infinity() : (a.build_s - b.build_s) / slopes;
}

}  // namespace

std::string rough_count(double rays) {
  constexpr const char* suffixes[] = {"", "k", "M", "G", "T"};
  std::size_t suffix = 0;
  while (rays >= 999.5 && suffix + 1 < std::size(suffixes)) {
    rays /= 1000;
    ++suffix;
  }
  if (rays >= 999.5) return fmt::format("{:.1e}{}", rays, suffixes[suffix]);
  return fmt::format("{:.{}f}{}", rays, rays < 9.95 && suffix > 0 ? 1 : 0, suffixes[suffix]);
}

std::string cheaper_when(const Cost& a, const Cost& b) {
  const bool builds_sooner = a.build_s<b.build_s, traces_faster = a.rays_per_s> b.rays_per_s;
  if (builds_sooner && a.rays_per_s >= b.rays_per_s) return "always";
  if (!builds_sooner && !traces_faster) return "never";
  if (a.build_s == b.build_s) return "always";
  return fmt::format("{} {} rays", traces_faster ? "from" : "up to", rough_count(crossing(a, b)));
}

std::vector<CheapestFor> cheapest(std::span<const Cost> costs) {
  std::vector<CheapestFor> result;
  if (costs.empty()) return result;
  std::size_t now = 0;
  for (std::size_t i = 1; i < costs.size(); ++i)
    if (costs[i].seconds(fewest_rays) < costs[now].seconds(fewest_rays)) now = i;
  double from = fewest_rays;
  for (;;) {
    // Only a faster tracer overtakes; the one that does so first.
    std::size_t next = now;
    double at = most_rays_shown;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      if (costs[i].rays_per_s <= costs[now].rays_per_s) continue;
      const double meets = crossing(costs[i], costs[now]);
      if (meets < at) {
        at = meets;
        next = i;
      }
    }
    result.push_back({now, from, at});
    if (next == now) return result;
    now = next;
    from = at;
  }
}

}  // namespace raymeter
