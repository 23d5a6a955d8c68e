#include "harness/tracing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "scenes/base/float_mode.h"
#include "tests/harness/test_scenes.h"

namespace raymeter {
namespace {

/// Answers each ray with its index in the batch, and records the chunks it was given.
class Recorder final : public Structure {
 public:
  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    note(batch, hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i)
      hits[i] = {batch.rays[i].tnear, static_cast<std::uint32_t>(batch.first + i)};
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    note(batch, occluded.size());
    for (std::size_t i = 0; i < occluded.size(); ++i) occluded[i] = (batch.first + i) % 3 == 0;
  }
  void count_closest(const BatchView& batch, std::span<Hit> hits,
                     std::span<RayCounters> counters) const override {
    trace_closest(batch, hits);
    for (RayCounters& ray : counters) ray.steps = 2;
  }
  void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                 std::span<RayCounters> counters) const override {
    trace_any(batch, occluded);
    for (RayCounters& ray : counters) ray.tests = 5;
  }
  StructureStats stats() const override { return {}; }

  mutable std::size_t rays_seen = 0, largest_chunk = 0, calls = 0;

 private:
  void note(const BatchView& batch, std::size_t answers) const {
    const std::lock_guard lock(mutex_);
    EXPECT_EQ(batch.rays.size(), answers);
    rays_seen += answers;
    ++calls;
    largest_chunk = std::max(largest_chunk, answers);
  }
  mutable std::mutex mutex_;
};

TEST(Tracing, ChunksCoverTheBatchOnce) {
  const RayBatch batch = random_batch(chunk_rays * 2 + 77, QueryKind::closest);
  for (const unsigned threads : {1u, 3u}) {
    const Recorder recorder;
    BatchAnswers answers;
    EXPECT_GE(trace(recorder, batch.view(), answers, threads), 0);
    EXPECT_EQ(recorder.rays_seen, batch.rays.size());
    EXPECT_LE(recorder.largest_chunk, chunk_rays);
    ASSERT_EQ(answers.hits.size(), batch.rays.size());
    EXPECT_TRUE(answers.occluded.empty());
    for (std::size_t i = 0; i < answers.hits.size(); ++i) ASSERT_EQ(answers.hits[i].primitive, i);
  }
}

TEST(Tracing, PassesAreTimedTogether) {
  const RayBatch batch = random_batch(700, QueryKind::closest);
  for (const unsigned threads : {1u, 3u}) {
    const Recorder recorder;
    BatchAnswers answers;
    EXPECT_GT(trace(recorder, batch.view(), answers, threads, 50), 0);
    EXPECT_EQ(recorder.rays_seen, 50 * batch.rays.size());
    ASSERT_EQ(answers.hits.size(), batch.rays.size());
    for (std::size_t i = 0; i < answers.hits.size(); ++i) ASSERT_EQ(answers.hits[i].primitive, i);
  }
}

TEST(Tracing, AnyHitAnswersReplaceFormerOnes) {
  const RayBatch batch = random_batch(1000, QueryKind::any);
  const Recorder recorder;
  BatchAnswers answers;
  answers.hits.resize(5);
  trace(recorder, batch.view(), answers);
  EXPECT_TRUE(answers.hits.empty());
  EXPECT_EQ(answers.size(), 1000u);
  EXPECT_EQ(count_hits(answers), 334u);
}

TEST(Tracing, CountsAddUpOnAnyNumberOfThreads) {
  const Scene scene = random_scene(40);
  const auto structure = build_brute_force(scene);
  for (const QueryKind query : {QueryKind::closest, QueryKind::any}) {
    const RayBatch batch = random_batch(3000, query);
    BatchAnswers timed, counted, counted_in_parallel;
    trace(*structure, batch.view(), timed);
    const CounterTotals totals = count(*structure, batch.view(), counted);
    const CounterTotals parallel = count(*structure, batch.view(), counted_in_parallel, 2);
    EXPECT_EQ(hit_hash(timed), hit_hash(counted));
    EXPECT_EQ(timed, counted_in_parallel);
    EXPECT_EQ(totals.rays, 3000u);
    EXPECT_EQ(totals.tests, parallel.tests);
    EXPECT_EQ(totals.distinct_tests, totals.tests);
    if (query == QueryKind::closest) {
      EXPECT_EQ(totals.tests, 3000u * 40);
    }
    EXPECT_LE(totals.tests, 3000u * 40);
    EXPECT_EQ(totals.tests_histogram.percentile(1), 40u);
  }
}

// A counting probe is as large as the scene.
TEST(Tracing, CountingMakesOneProbeForEachThread) {
  for (const QueryKind query : {QueryKind::closest, QueryKind::any})
    for (const std::size_t rays : {std::size_t{0}, std::size_t{2}, std::size_t{10000}, chunk_rays * 2 + 77}) {
      const RayBatch batch = random_batch(rays, query);
      for (const unsigned threads : {1u, 3u}) {
        const Recorder recorder;
        BatchAnswers answers;
        EXPECT_EQ(count(recorder, batch.view(), answers, threads).rays, rays);
        EXPECT_EQ(recorder.rays_seen, rays);
        EXPECT_EQ(recorder.calls, std::min<std::size_t>(rays, threads));
      }
    }
}

TEST(Tracing, HitHashSeesEveryBit) {
  BatchAnswers a;
  a.hits = {{1, 2}, {3, 4}};
  BatchAnswers t = a, id = a, order = a, any;
  t.hits[1].t = std::nextafter(3.0f, 4.0f);
  id.hits[0].primitive = 7;
  std::swap(order.hits[0], order.hits[1]);
  any.occluded = {0, 1};
  EXPECT_EQ(hit_hash(a), hit_hash(BatchAnswers(a)));
  for (const BatchAnswers& other : {t, id, order, any, BatchAnswers{}})
    EXPECT_NE(hit_hash(a), hit_hash(other));
  BatchAnswers any_other = any;
  any_other.occluded[0] = 1;
  EXPECT_NE(hit_hash(any), hit_hash(any_other));
}

/// Answers with a product that is denormal, unless denormals are flushed.
class Denormal final : public Structure {
 public:
  void trace_closest(const BatchView&, std::span<Hit> hits) const override {
    const volatile float tiny = 1e-38f;
    for (Hit& hit : hits) hit.t = tiny * 0.1f;
  }
  void trace_any(const BatchView&, std::span<std::uint8_t>) const override {}
  void count_closest(const BatchView&, std::span<Hit>, std::span<RayCounters>) const override {}
  void count_any(const BatchView&, std::span<std::uint8_t>, std::span<RayCounters>) const override {}
  StructureStats stats() const override { return {}; }
};

TEST(Tracing, RunsWithDenormalsFlushed) {
  if (!FlushDenormals::available) GTEST_SKIP() << "this processor has no such mode";
  const RayBatch batch = random_batch(2000, QueryKind::closest);
  for (const unsigned threads : {1u, 2u}) {
    BatchAnswers answers;
    trace(Denormal(), batch.view(), answers, threads);
    for (const Hit& hit : answers.hits) ASSERT_EQ(hit.t, 0);
  }
}

}  // namespace
}  // namespace raymeter
