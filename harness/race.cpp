#include "harness/race.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "harness/pinned_thread.h"

namespace raymeter {
namespace {

constexpr double slow_pass_seconds = 1;

/// A clock may stand still over a handful of rays.
constexpr double shortest_seconds = 1e-9;

/// Traces the batch as often as its side's repetitions say; returns rays per second.
double run(const Structure& structure, const BatchView& batch, RaceSide& side, unsigned threads) {
  const double seconds = trace(structure, batch, side.answers, threads, side.repetitions);
  return static_cast<double>(batch.rays.size()) * side.repetitions / std::max(seconds, shortest_seconds);
}

/// Traces with twice the repetitions each time, until they last `min_round_seconds`, and chooses the
/// repetitions so that a round lasts as long. Returns the seconds of a pass, by the last of these trials.
double warm_up(const Structure& structure, const BatchView& batch, RaceSide& side,
               const RaceSettings& settings) {
  constexpr unsigned most_repetitions = 1u << 20u;
  double seconds = trace(structure, batch, side.answers, settings.threads);
  while (seconds < settings.min_round_seconds && side.repetitions < most_repetitions) {
    side.repetitions *= 2;
    seconds = trace(structure, batch, side.answers, settings.threads, side.repetitions);
  }
  const double pass = std::max(seconds, shortest_seconds) / side.repetitions;
  const double wanted = std::ceil(settings.min_round_seconds / pass);
  side.repetitions = static_cast<unsigned>(std::clamp(wanted, 1.0, double{most_repetitions}));
  return pass;
}

void add_statistics(RaceResult& result) {
  result.baseline.median_rays_per_second = median(result.baseline.rays_per_second);
  result.structure.median_rays_per_second = median(result.structure.rays_per_second);
  result.ratio = median(result.ratios);
  result.ratio_interval = median_interval(result.ratios);
  result.spread = relative_spread(result.ratios);
  result.noisy = result.spread > noisy_spread;
}

}  // namespace

RaceResult race(Structure& baseline, Structure& structure, const RayBatch& batch,
                const RaceSettings& settings) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };

  RaceResult result;
  result.threads = std::max(1u, settings.threads);
  const BatchView view = batch.view();
  baseline.prepare(view);
  structure.prepare(view);

  const auto run_rounds = [&] {
    if (view.rays.empty()) return;
    const auto keep_round = [&](double ours, double theirs) {
      result.baseline.rays_per_second.push_back(theirs);
      result.structure.rays_per_second.push_back(ours);
      result.ratios.push_back(ours / theirs);
    };
    warm_up(baseline, view, result.baseline, settings);
    const double pass = warm_up(structure, view, result.structure, settings);
    // A pass of seconds has long warmed itself up: it is not thrown away, it is the first round.
    const bool slow = pass >= slow_pass_seconds;
    if (slow)
      keep_round(static_cast<double>(view.rays.size()) / pass,
                 run(baseline, view, result.baseline, result.threads));
    const unsigned least_rounds = slow ? 1 : 3;
    while (result.rounds() < settings.rounds) {
      const unsigned round = result.rounds();
      if (round >= least_rounds && elapsed() + (slow ? pass : 0) >= settings.time_budget) break;
      double ours = 0, theirs = 0;
      for (const bool baseline_turn : {round % 2 == 0, round % 2 != 0}) {
        if (baseline_turn)
          theirs = run(baseline, view, result.baseline, result.threads);
        else
          ours = run(structure, view, result.structure, result.threads);
      }
      keep_round(ours, theirs);
    }
  };
  if (result.threads == 1) {
    const PinnedThread pin;
    result.pinned = pin.pinned();
    run_rounds();
  } else {
    run_rounds();
  }

  add_statistics(result);
  return result;
}

RaceResult sum_of_races(std::span<const RaceResult> races, std::span<const std::size_t> rays) {
  RaceResult sum;
  std::size_t rounds = std::numeric_limits<std::size_t>::max();
  double all_rays = 0;
  sum.pinned = true;
  for (std::size_t i = 0; i < races.size(); ++i) {
    if (rays[i] == 0) continue;
    rounds = std::min<std::size_t>(rounds, races[i].rounds());
    all_rays += static_cast<double>(rays[i]);
    sum.pinned = sum.pinned && races[i].pinned;
    sum.threads = races[i].threads;
  }
  if (all_rays == 0) rounds = 0;
  for (std::size_t round = 0; round < rounds; ++round) {
    double ours = 0, theirs = 0;  // seconds
    for (std::size_t i = 0; i < races.size(); ++i) {
      if (rays[i] == 0) continue;
      ours += static_cast<double>(rays[i]) / races[i].structure.rays_per_second[round];
      theirs += static_cast<double>(rays[i]) / races[i].baseline.rays_per_second[round];
    }
    sum.structure.rays_per_second.push_back(all_rays / ours);
    sum.baseline.rays_per_second.push_back(all_rays / theirs);
    sum.ratios.push_back(theirs / ours);
  }
  add_statistics(sum);
  return sum;
}

}  // namespace raymeter
