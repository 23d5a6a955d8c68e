#pragma once
// Work on many items on the threads of a build. Every build runs in a task arena of as many threads as it was
// given (Registry::build), and must make the same structure for any number of them: nothing here depends on
// how the items are shared out.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
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

/// Calls begin(i), middle(i) and end(i) for each of so many items, with denormals flushed: the middles one
/// after the other and in order, the rest on all threads. Few items are under way at a time, so that what
/// begin(i) touched is still at hand for end(i).
template <class Begin, class Middle, class End>
void for_each_in_order(std::uint64_t items, const Begin& begin, const Middle& middle, const End& end) {
  const auto step = [](const auto& work) {
    return [&work](std::uint64_t i) {
      const FlushDenormals mode;
      work(i);
      return i;
    };
  };
  std::uint64_t next = 0;
  const auto number = [&](tbb::flow_control& control) {
    if (next == items) control.stop();
    return next++;
  };
  using Item = std::uint64_t;
  constexpr auto parallel = tbb::filter_mode::parallel, in_order = tbb::filter_mode::serial_in_order;
  tbb::parallel_pipeline(2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                         tbb::make_filter<void, Item>(in_order, number) &
                             tbb::make_filter<Item, Item>(parallel, step(begin)) &
                             tbb::make_filter<Item, Item>(in_order, step(middle)) &
                             tbb::make_filter<Item, void>(parallel, step(end)));
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
