#include "harness/race.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <thread>

#include "accel/per_ray_structure.h"
#include "tests/harness/test_scenes.h"

namespace raymeter {
namespace {

void expect_sound(const RaceResult& result) {
  EXPECT_GT(result.ratio, 0);
  EXPECT_LE(result.ratio_interval.low, result.ratio);
  EXPECT_GE(result.ratio_interval.high, result.ratio);
  EXPECT_GE(result.spread, 0);
  EXPECT_EQ(result.noisy, result.spread > noisy_spread);
  EXPECT_EQ(result.baseline.rays_per_second.size(), result.rounds());
  EXPECT_EQ(result.structure.rays_per_second.size(), result.rounds());
  for (unsigned i = 0; i < result.rounds(); ++i)
    EXPECT_DOUBLE_EQ(result.ratios[i],
                     result.structure.rays_per_second[i] / result.baseline.rays_per_second[i]);
}

TEST(Race, AgainstItselfIsSound) {
  const Scene scene = random_scene(60);
  const auto structure = build_brute_force(scene);
  const RayBatch batch = random_batch(2000, QueryKind::closest);
  cpu_set_t before{}, after{};
  sched_getaffinity(0, sizeof before, &before);
  RaceSettings settings;
  settings.min_round_seconds = 0.005;
  for (const unsigned threads : {1u, 2u}) {
    settings.threads = threads;
    const RaceResult result = race(*structure, *structure, batch, settings);
    expect_sound(result);
    EXPECT_EQ(result.rounds(), 5u);
    EXPECT_EQ(result.threads, threads);
    EXPECT_FALSE(threads > 1 && result.pinned);
    // The answers of the timed passes are there to be hashed and graded.
    BatchAnswers expected;
    trace(*structure, batch.view(), expected);
    EXPECT_EQ(result.structure.answers, expected);
    EXPECT_EQ(result.baseline.answers, expected);
  }
  sched_getaffinity(0, sizeof after, &after);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
}

TEST(Race, RepeatsShortBatches) {
  const Scene scene = random_scene(5);
  const auto structure = build_brute_force(scene);
  const RayBatch batch = random_batch(10, QueryKind::any);
  RaceSettings settings;
  settings.rounds = 3;
  settings.min_round_seconds = 0.002;
  const RaceResult result = race(*structure, *structure, batch, settings);
  expect_sound(result);
  EXPECT_GT(result.baseline.repetitions, 10u);
  EXPECT_GT(result.structure.repetitions, 10u);
}

/// Answers nothing at once: all that can be timed is what is round it.
class Nothing final : public Structure {
 public:
  void trace_closest(const BatchView&, std::span<Hit>) const override {}
  void trace_any(const BatchView&, std::span<std::uint8_t>) const override {}
  void count_closest(const BatchView&, std::span<Hit>, std::span<RayCounters>) const override {}
  void count_any(const BatchView&, std::span<std::uint8_t>, std::span<RayCounters>) const override {}
  StructureStats stats() const override { return {}; }
};

// Reading the thread's clock takes 200 ns or more, a pass of nothing far less.
TEST(Race, OfATinyBatchTimesTheRaysAndNotTheClock) {
  double clock_seconds = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < 5; ++trial) {
    timespec time{};
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 1000; ++i) clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    clock_seconds =
        std::min(clock_seconds,
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 1000);
  }
  Nothing nothing;
  RaceSettings settings;
  settings.rounds = 3;
  settings.min_round_seconds = 0.002;
  const RaceResult result = race(nothing, nothing, random_batch(1, QueryKind::closest), settings);
  EXPECT_LT(1 / result.structure.median_rays_per_second, clock_seconds);
  EXPECT_GT(result.structure.repetitions, 1000u);
}

TEST(Race, StopsAtItsBudgetButNotBeforeThreeRounds) {
  const Scene scene = random_scene(5);
  const auto structure = build_brute_force(scene);
  const RayBatch batch = random_batch(10, QueryKind::closest);
  RaceSettings settings;
  settings.rounds = 50;
  settings.min_round_seconds = 0.001;
  settings.time_budget = 0;
  EXPECT_EQ(race(*structure, *structure, batch, settings).rounds(), 3u);
  settings.rounds = 2;
  EXPECT_EQ(race(*structure, *structure, batch, settings).rounds(), 2u);
}

/// Takes more than a second for a pass. On several threads the clock is the wall's, so sleeping will do.
class Sleeper final : public PerRayStructure<Sleeper> {
 public:
  explicit Sleeper(const Scene& scene) : PerRayStructure(scene) {}
  template <class Probe>
  Hit closest_hit(const Ray&, Probe&) const {
    ++passes;
    std::this_thread::sleep_for(std::chrono::milliseconds(1050));
    return {};
  }
  template <class Probe>
  bool any_hit(const Ray&, Probe&) const {
    return false;
  }
  StructureStats stats() const override { return {}; }

  mutable std::atomic<int> passes = 0;
};

TEST(Race, OfASlowStructureKeepsItsFirstPassAndRunsOnlyTheRoundsThatFit) {
  const Scene scene = random_scene(5);
  const auto baseline = build_brute_force(scene);
  Sleeper slow(scene);
  RaceSettings settings;
  settings.rounds = 50;
  settings.threads = 2;
  settings.min_round_seconds = 0.001;
  settings.time_budget = 1.5;
  const RaceResult result = race(*baseline, slow, random_batch(1, QueryKind::closest), settings);
  EXPECT_EQ(result.rounds(), 1u);
  EXPECT_EQ(slow.passes, 1) << "a warm-up of seconds was thrown away";
  EXPECT_GT(result.structure.median_rays_per_second, 0.5);
  EXPECT_LT(result.structure.median_rays_per_second, 1.0);
}

TEST(Race, OfNoRaysHasNoRounds) {
  const Scene scene = random_scene(5);
  const auto structure = build_brute_force(scene);
  const RaceResult result = race(*structure, *structure, random_batch(0, QueryKind::closest), {});
  EXPECT_EQ(result.rounds(), 0u);
  EXPECT_TRUE(std::isnan(result.ratio));
  EXPECT_FALSE(result.noisy);
}

/// Both runners write who is tracing into one list.
class Runner final : public Structure {
 public:
  Runner(char name, std::string& order) : name_(name), order_(order) {}
  void trace_closest(const BatchView&, std::span<Hit>) const override {
    if (order_.empty() || order_.back() != name_) order_ += name_;
    volatile double work = 1;
    for (int i = 0; i < 100000; ++i) work = work * 1.0000001;
  }
  void trace_any(const BatchView&, std::span<std::uint8_t>) const override {}
  void count_closest(const BatchView&, std::span<Hit>, std::span<RayCounters>) const override {}
  void count_any(const BatchView&, std::span<std::uint8_t>, std::span<RayCounters>) const override {}
  void prepare(const BatchView& batch) override { prepared = batch.rays.size(); }
  StructureStats stats() const override { return {}; }
  std::size_t prepared = 0;

 private:
  char name_;
  std::string& order_;
};

TEST(Race, AlternatesWhoBeginsAndPreparesBoth) {
  std::string order;
  Runner baseline('b', order), structure('s', order);
  RaceSettings settings;
  settings.rounds = 4;
  settings.min_round_seconds = 0;
  race(baseline, structure, random_batch(10, QueryKind::closest), settings);
  // Warm-up b s, then b s, s b, b s, s b: neighbours of the same name are written once.
  EXPECT_EQ(order, "bsbsbsb");
  EXPECT_EQ(baseline.prepared, 10u);
  EXPECT_EQ(structure.prepared, 10u);
}

TEST(Race, OfSeveralBatchesTakesTheTimeOfAll) {
  std::vector<RaceResult> races(3);
  races[0].structure.rays_per_second = {100, 200, 100};
  races[0].baseline.rays_per_second = {400, 400, 400};
  races[0].ratios = {0.25, 0.5, 0.25};
  races[0].pinned = true;
  races[1].structure.rays_per_second = {50, 50, 50, 50};
  races[1].baseline.rays_per_second = {25, 50, 100, 100};
  races[1].ratios = {2, 1, 0.5, 0.5};
  races[1].pinned = true;
  // races[2] had no rays.
  const std::vector<std::size_t> rays{400, 100, 0};
  const RaceResult sum = sum_of_races(races, rays);
  expect_sound(sum);
  ASSERT_EQ(sum.rounds(), 3u);  // as many as both have
  // Seconds: 4 + 2 against 1 + 4; 2 + 2 against 1 + 2; 4 + 2 against 1 + 1.
  EXPECT_DOUBLE_EQ(sum.structure.rays_per_second[0], 500.0 / 6);
  EXPECT_DOUBLE_EQ(sum.baseline.rays_per_second[0], 500.0 / 5);
  EXPECT_DOUBLE_EQ(sum.ratios[0], 5.0 / 6);
  EXPECT_DOUBLE_EQ(sum.ratios[1], 3.0 / 4);
  EXPECT_DOUBLE_EQ(sum.ratios[2], 2.0 / 6);
  EXPECT_DOUBLE_EQ(sum.ratio, 3.0 / 4);
  EXPECT_TRUE(sum.pinned);
  races[0].pinned = false;
  EXPECT_FALSE(sum_of_races(races, rays).pinned);
  EXPECT_EQ(sum_of_races(races, std::vector<std::size_t>{0, 0, 0}).rounds(), 0u);
}

}  // namespace
}  // namespace raymeter
