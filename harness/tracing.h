#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/structure.h"
#include "harness/counters.h"

namespace raymeter {

/// What one structure answered on one whole batch: `hits` of a closest-hit batch, `occluded` of an any-hit
/// batch; the other one is empty.
struct BatchAnswers {
  std::vector<Hit> hits;
  std::vector<std::uint8_t> occluded;

  std::size_t size() const { return hits.size() + occluded.size(); }
  friend bool operator==(const BatchAnswers&, const BatchAnswers&) = default;
};

/// Of (t, primitive) of every ray in order, t by its bits; or of the occluded bytes.
std::uint64_t hit_hash(const BatchAnswers& answers);

/// How many rays hit something.
std::uint64_t count_hits(const BatchAnswers& answers);

/// Threads for what is not timed: one for each CPU.
unsigned all_cpus();

/// The most rays in one timed call of a structure. Batches on several threads are cut finer, so that all have
/// work.
inline constexpr std::size_t chunk_rays = std::size_t{1} << 16u;

/// Room for the answers of a batch, as `trace` and `count` make it where it is not there.
void make_room(BatchAnswers& answers, const BatchView& batch);

/// Traces all rays of `batch` chunk by chunk with denormals flushed, on this thread (threads = 1) or on
/// `threads` of them, `passes` times over, and returns the seconds that all passes took together: CPU time of
/// this thread for one thread, wall-clock time for more. The clock is read before the
/// first pass and after the last, so that many passes of a few rays time the rays, not the clock. Making room
/// for the answers is not timed. `prepare` is the caller's affair.
double trace(const Structure& structure, const BatchView& batch, BatchAnswers& answers, unsigned threads = 1,
             unsigned passes = 1);

/// The counted pass: the same answers, with the counters of all rays together. The structure must count. The
/// rays are shared out evenly, one call of the structure for each thread, or for each 2^20 rays.
CounterTotals count(const Structure& structure, const BatchView& batch, BatchAnswers& answers,
                    unsigned threads = 1);

}  // namespace raymeter
