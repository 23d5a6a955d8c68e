// The lists of the occupied cells, and how these are numbered, where words of 64 cells begin and end.
#include "accel/sparse_lists.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <set>

#include "scenes/base/random.h"

namespace raymeter {
namespace {

struct CellRun {
  std::uint64_t first, count;
};

/// That exactly the cells of the runs are members, and are numbered in ascending order.
void expect_members(std::uint64_t cells, const std::vector<CellRun>& runs) {
  for (const bool shared : {false, true}) {
    MemoryMeter meter;
    OccupiedCells occupied(meter);
    occupied.reset(cells);
    std::set<std::uint64_t> members;
    for (const CellRun& run : runs) {
      occupied.insert(run.first, run.count, shared);
      for (std::uint64_t c = 0; c < run.count; ++c) members.insert(run.first + c);
    }
    EXPECT_EQ(occupied.number(), members.size());
    std::uint32_t number = 0;
    for (std::uint64_t c = 0; c < cells; ++c) {
      ASSERT_EQ(occupied.contains(c), members.contains(c)) << "cell " << c << " of " << cells;
      if (members.contains(c)) {
        ASSERT_EQ(occupied.number_of(c), number++) << "cell " << c << " of " << cells;
      }
    }
    EXPECT_EQ(occupied.cells(), cells);
    EXPECT_EQ(occupied.bytes(), (cells + 63) / 64 * 12);
    EXPECT_EQ(occupied.bytes(), meter.bytes());
  }
}

TEST(OccupiedCells, AreNumberedAcrossWords) {
  for (const std::uint64_t cells : {1, 2, 63, 64, 65, 127, 128, 129, 200}) {
    expect_members(cells, {});
    expect_members(cells, {{0, cells}});
    expect_members(cells, {{cells - 1, 1}});
    expect_members(cells, {{0, 1}, {cells - 1, 1}, {0, 1}});
    for (std::uint64_t first = 0; first < cells; ++first)
      expect_members(cells, {{first, std::min<std::uint64_t>(cells - first, 1 + first % 70)}});
  }
  expect_members(1000, {{60, 8}, {64, 64}, {128, 1}, {191, 2}, {300, 500}, {63, 1}, {999, 1}});
}

TEST(OccupiedCells, ForgetWhatTheyHeld) {
  MemoryMeter meter;
  OccupiedCells occupied(meter);
  occupied.reset(130);
  occupied.insert(0, 130, false);
  EXPECT_EQ(occupied.number(), 130u);
  occupied.reset(65);
  occupied.insert(64, 1, false);
  EXPECT_EQ(occupied.number(), 1u);
  EXPECT_FALSE(occupied.contains(0));
  EXPECT_EQ(occupied.number_of(64), 0u);
}

TEST(OccupiedCells, AreNumberedAlikeByManyThreads) {
  const std::uint64_t cells = 3000001;
  Random random(1);
  std::vector<CellRun> runs(50000);
  for (CellRun& run : runs) run = {random.below(cells - 300), 1 + random.below(random.below(8) ? 3 : 300)};
  std::vector<std::uint32_t> expected;
  for (const int threads : {1, 3}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      MemoryMeter meter;
      OccupiedCells occupied(meter);
      occupied.reset(cells);
      for_ranges(runs.size(), 100, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i)
          occupied.insert(runs[i].first, runs[i].count, is_parallel());
      });
      std::vector<std::uint32_t> numbers{occupied.number()};
      for (const CellRun& run : runs) numbers.push_back(occupied.number_of(run.first));
      if (expected.empty()) expected = numbers;
      EXPECT_EQ(numbers, expected) << threads;
    });
  }
}

/// Many runs a primitive, some longer than a word, some cells crowded, most empty.
TEST(SparseLists, AreEqualForAnyNumberOfThreads) {
  const std::uint32_t cells = 100003, primitives = 3001;
  const auto runs_of = [&](std::uint32_t p, const auto& add) {
    Random random(p);
    for (std::uint32_t i = p % 40; i > 0; --i) {
      const std::uint32_t first = 64 * random.below(200) + random.below(3);
      add(first, 1 + random.below(p % 100 == 0 ? 2000 : 3));
    }
    add(cells - 1, 1);
  };
  std::vector<std::vector<std::uint32_t>> expected(cells);
  for (std::uint32_t p = 0; p < primitives; ++p) {
    std::set<std::uint32_t> held;
    runs_of(p, [&](std::uint32_t first, std::uint32_t count) {
      for (std::uint32_t c = first; c < first + count; ++c)
        if (held.insert(c).second) expected[c].push_back(p);
    });
  }
  const auto empty = static_cast<std::uint64_t>(std::ranges::count(expected, std::vector<std::uint32_t>{}));
  ASSERT_GT(empty, cells / 2);
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] {
      MemoryMeter meter;
      SparseLists lists(meter);
      EXPECT_TRUE(
          lists.build(cells, primitives, [&](std::uint32_t begin, std::uint32_t end, const auto& add) {
            for (std::uint32_t p = begin; p < end; ++p) {
              // Each cell once.
              std::set<std::uint32_t> held;
              runs_of(p, [&](std::uint32_t first, std::uint32_t count) {
                for (std::uint32_t c = first; c < first + count; ++c) held.insert(c);
              });
              for (auto c = held.begin(); c != held.end();) {
                const std::uint32_t first = *c;
                std::uint32_t count = 0;
                while (c != held.end() && *c == first + count) ++c, ++count;
                add(p, first, count);
              }
            }
            return true;
          }));
      for (std::uint32_t c = 0; c < cells; ++c)
        ASSERT_TRUE(std::ranges::equal(lists[c], expected[c])) << "cell " << c << ", threads " << threads;
      EXPECT_EQ(lists.cells(), cells);
      EXPECT_EQ(lists.empty_cells(), empty);
      EXPECT_EQ(meter.bytes(), lists.cell_bytes() + lists.reference_bytes());
      EXPECT_EQ(lists.cell_bytes(), (cells + 63) / 64 * 12 + (cells - empty + 1) * 4);
      EXPECT_EQ(lists.reference_bytes(), 4 * lists.references());
    });
  }
}

TEST(SparseLists, OfNothing) {
  MemoryMeter meter;
  SparseLists lists(meter);
  EXPECT_TRUE(lists.build(65, 0, [](std::uint32_t, std::uint32_t, const auto&) { return true; }));
  EXPECT_EQ(lists.cells(), 65u);
  EXPECT_EQ(lists.empty_cells(), 65u);
  EXPECT_EQ(lists.references(), 0u);
  EXPECT_TRUE(lists[64].empty());
}

TEST(SparseLists, AreGivenUpAndBuiltAnew) {
  MemoryMeter meter;
  SparseLists lists(meter);
  const auto build = [&](std::uint64_t cells, bool goes_on) {
    return lists.build(cells, 1000, [&](std::uint32_t begin, std::uint32_t end, const auto& add) {
      for (std::uint32_t p = begin; p < end; ++p) add(p, p % cells, 1);
      return goes_on || begin == 0;
    });
  };
  EXPECT_FALSE(build(2000, false));
  EXPECT_TRUE(build(500, true));
  for (std::uint32_t c = 0; c < 500; ++c)
    ASSERT_TRUE(std::ranges::equal(lists[c], std::array{c, c + 500})) << c;
}

TEST(SparseLists, KeepToTheirMemory) {
  const auto enumerate = [](std::uint32_t begin, std::uint32_t end, const auto& add) {
    for (std::uint32_t p = begin; p < end; ++p) add(p, 0, 1000);
    return true;
  };
  MemoryMeter enough;
  SparseLists(enough).build(1000, 1000, enumerate);
  // The runs are no longer there once all is built, but at the peak.
  EXPECT_GT(enough.peak(), 4 * 1000 * 1000 + 8 * 1000);
  MemoryMeter less(enough.peak() - 1);
  EXPECT_THROW(SparseLists(less).build(1000, 1000, enumerate), MemoryLimitExceeded);
  EXPECT_EQ(less.bytes(), 0u);
}

}  // namespace
}  // namespace raymeter
