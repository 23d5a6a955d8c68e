#pragma once
// Work on many items on the threads of a build. Every build runs in a task arena of as many threads as it was
// given (Registry::build), and must make the same structure for any number of them: nothing here depends on
// how the items are shared out.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <cstdint>

#include "scenes/base/float_mode.h"

namespace raymeter {

/// Whether more than one thread may work here.
inline bool is_parallel() {
  return tbb::this_task_arena::max_concurrency() > 1;
}

/// Calls work(begin, end) on ranges of about `grain` items that together are 0 .. items, with denormals
/// flushed.
template <class Work>
void for_ranges(std::uint64_t items, std::uint64_t grain, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, items, grain), [&](const auto& range) {
    const FlushDenormals mode;
    work(range.begin(), range.end());
  });
}

/// The sum of term(begin, end) over ranges that together are 0 .. items. How they are cut and in which order
/// they are added depends on `items` and `grain` alone, so that floating sums are equal for any number of
/// threads.
template <class Value, class Term>
Value sum_of_ranges(std::uint64_t items, std::uint64_t grain, const Term& term) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::uint64_t>(0, items, grain), Value{},
      [&](const auto& range, const Value& sum) {
        const FlushDenormals mode;
        return sum + term(range.begin(), range.end());
      },
      [](const Value& a, const Value& b) { return a + b; });
}

}  // namespace raymeter
