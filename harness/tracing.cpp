#include "harness/tracing.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <ctime>
#include <mutex>
#include <thread>

#include "scenes/base/float_mode.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

double now(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Calls work(chunk, first, count) for every chunk of the batch, each once in each pass.
template <class Work>
void for_chunks(const BatchView& batch, unsigned threads, std::size_t chunk_size, unsigned passes,
                const Work& work) {
  const std::size_t rays = batch.rays.size();
  const auto do_chunk = [&](std::size_t index) {
    const FlushDenormals mode;
    const std::size_t first = index * chunk_size, count = std::min(chunk_size, rays - first);
    BatchView chunk = batch;
    chunk.rays = batch.rays.subspan(first, count);
    chunk.first = batch.first + first;
    work(chunk, first, count);
  };
  const std::size_t chunks = (rays + chunk_size - 1) / chunk_size;
  if (threads <= 1) {
    for (unsigned pass = 0; pass < passes; ++pass)
      for (std::size_t i = 0; i < chunks; ++i) do_chunk(i);
    return;
  }
  // As many threads as asked for, even where there are fewer CPUs.
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(static_cast<int>(threads));
  arena.execute([&] {
    for (unsigned pass = 0; pass < passes; ++pass)
      tbb::parallel_for(std::size_t{0}, chunks, do_chunk, tbb::simple_partitioner());
  });
}

/// Eight chunks a thread balance the load; below 256 rays a chunk costs more than it helps.
std::size_t timed_chunk(std::size_t rays, unsigned threads) {
  if (threads <= 1) return chunk_rays;
  return std::clamp<std::size_t>(rays / (std::size_t{8} * threads), 256, chunk_rays);
}

/// One chunk a thread, since every chunk has a counting probe, which is as large as the scene; but no more
/// rays than have their counters in 40 MB.
std::size_t counted_chunk(std::size_t rays, unsigned threads) {
  constexpr std::size_t most = std::size_t{1} << 20u;
  return std::clamp<std::size_t>((rays + threads - 1) / std::max(1u, threads), 1, most);
}

}  // namespace

std::uint64_t hit_hash(const BatchAnswers& answers) {
  static_assert(sizeof(Hit) == sizeof(float) + sizeof(std::uint32_t));
  Hasher hasher;
  hasher.array(std::span<const Hit>(answers.hits));
  hasher.array(std::span<const std::uint8_t>(answers.occluded));
  return hasher.digest();
}

std::uint64_t count_hits(const BatchAnswers& answers) {
  return static_cast<std::uint64_t>(
      std::count_if(answers.hits.begin(), answers.hits.end(), [](const Hit& hit) { return hit.found(); }) +
      std::count(answers.occluded.begin(), answers.occluded.end(), std::uint8_t{1}));
}

unsigned all_cpus() {
  return std::max(1u, std::thread::hardware_concurrency());
}

void make_room(BatchAnswers& answers, const BatchView& batch) {
  const bool closest = batch.query == QueryKind::closest;
  answers.hits.resize(closest ? batch.rays.size() : 0);
  answers.occluded.resize(closest ? 0 : batch.rays.size());
}

double trace(const Structure& structure, const BatchView& batch, BatchAnswers& answers, unsigned threads,
             unsigned passes) {
  make_room(answers, batch);
  const clockid_t clock = threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
  const auto trace_chunk = [&](const BatchView& chunk, std::size_t first, std::size_t rays) {
    if (batch.query == QueryKind::closest)
      structure.trace_closest(chunk, std::span(answers.hits).subspan(first, rays));
    else
      structure.trace_any(chunk, std::span(answers.occluded).subspan(first, rays));
  };
  const double start = now(clock);
  for_chunks(batch, threads, timed_chunk(batch.rays.size(), threads), passes, trace_chunk);
  return now(clock) - start;
}

CounterTotals count(const Structure& structure, const BatchView& batch, BatchAnswers& answers,
                    unsigned threads) {
  make_room(answers, batch);
  CounterTotals totals;
  std::mutex totals_mutex;
  const auto count_chunk = [&](const BatchView& chunk, std::size_t first, std::size_t rays) {
    std::vector<RayCounters> counters(rays);
    if (batch.query == QueryKind::closest)
      structure.count_closest(chunk, std::span(answers.hits).subspan(first, rays), counters);
    else
      structure.count_any(chunk, std::span(answers.occluded).subspan(first, rays), counters);
    // Sums of whole numbers: the order in which chunks arrive does not matter.
    const std::lock_guard lock(totals_mutex);
    totals.add(counters);
  };
  for_chunks(batch, threads, counted_chunk(batch.rays.size(), threads), 1, count_chunk);
  return totals;
}

}  // namespace raymeter
