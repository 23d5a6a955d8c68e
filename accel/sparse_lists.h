#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "accel/cell_lists.h"
#include "accel/memory_meter.h"
#include "accel/occupied_cells.h"
#include "accel/parallel.h"

namespace raymeter {

/// CellLists of a grid of which most cells are empty: only the others have a list.
class SparseLists {
 public:
  explicit SparseLists(MemoryMeter& meter) : meter_(meter), occupied_(meter), lists_(meter) {}

  /// Fills the lists of `cells` cells, at most 2^32: enumerate(begin, end, add) must call
  /// add(primitive, first, count) for runs of cells side by side that are to hold the primitives begin ..
  /// end - 1, in ascending order of primitives, and is called once for each of them, on several threads. When
  /// it returns false the work is given up, and so does this. Every list holds its primitives in ascending
  /// order. Takes time linear in primitives, runs and pairs, and a little for each 64 cells; while building 8
  /// bytes for each run. Throws Error for 2^32 pairs and more, MemoryLimitExceeded.
  template <class Enumerate>
  bool build(std::uint64_t cells, std::uint64_t primitives, const Enumerate& enumerate) {
    // Which cells hold anything?
    occupied_.reset(cells);
    const bool shared = is_parallel();
    const RawMeteredVector<Run> none{RawMeteredAllocator<Run>(meter_)};
    std::vector<RawMeteredVector<Run>> parts((primitives + part_size - 1) / part_size, none);
    std::atomic<bool> given_up = false;
    for_ranges(parts.size(), 4, [&](std::uint64_t begin, std::uint64_t end) {
      std::array<Run, 4096> some;
      for (std::uint64_t part = begin; part < end && !given_up; ++part) {
        const auto base = static_cast<std::uint32_t>(part * part_size);
        const auto last = static_cast<std::uint32_t>(std::min(base + part_size, primitives));
        Run* next = some.data();
        const auto flush = [&] {
          parts[part].insert(parts[part].end(), some.data(), next);
          next = some.data();
        };
        if (!enumerate(base, last, [&](std::uint32_t p, std::uint64_t first, std::uint64_t count) {
              occupied_.insert(first, count, shared);
              *next++ = {static_cast<std::uint32_t>(first), static_cast<std::uint16_t>(count),
                         static_cast<std::uint16_t>(p - base)};
              if (next == some.data() + some.size()) flush();
            }))
          given_up = true;
        flush();
      }
    });
    if (given_up) return false;

    // From cells to the numbers of those that do.
    const std::uint32_t lists = occupied_.number();
    for_ranges(parts.size(), 4, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t part = begin; part < end; ++part)
        for (Run& run : parts[part]) run.first = occupied_.number_of(run.first);
    });

    lists_.build_by_stretches(lists, [&](std::uint32_t low, std::uint32_t high, const auto& add) {
      const auto for_each_pair = [&](const auto& clipped) {
        for (std::uint64_t part = 0; part < parts.size(); ++part) {
          const auto base = static_cast<std::uint32_t>(part * part_size);
          for (const Run& run : parts[part]) {
            const auto [begin, end] = clipped(run.first, run.first + run.count);
            for (std::uint32_t c = begin; c < end; ++c) add(c, base + run.primitive);
          }
        }
      };
      using Range = std::pair<std::uint32_t, std::uint32_t>;
      if (low == 0 && high == lists)
        for_each_pair([](std::uint32_t begin, std::uint32_t end) { return Range(begin, end); });
      else
        for_each_pair([&](std::uint32_t begin, std::uint32_t end) {
          return Range(std::max(begin, low), std::min(end, high));
        });
    });
    return true;
  }

  std::span<const std::uint32_t> operator[](std::uint64_t cell) const {
    if (!occupied_.contains(cell)) return {};
    return lists_[occupied_.number_of(cell)];
  }
  std::uint64_t cells() const { return occupied_.cells(); }
  std::uint64_t references() const { return lists_.references(); }
  std::uint64_t empty_cells() const { return cells() - lists_.cells(); }
  std::uint64_t cell_bytes() const { return occupied_.bytes() + lists_.offset_bytes(); }
  std::uint64_t reference_bytes() const { return lists_.reference_bytes(); }

 private:
  static constexpr std::uint64_t part_size = 256;  // primitives

  /// Of a primitive, counted from the first of its part. `first`: a cell, then its number among the occupied.
  struct Run {
    std::uint32_t first;
    std::uint16_t count, primitive;
  };

  MemoryMeter& meter_;
  OccupiedCells occupied_;
  CellLists lists_;  // by the cells' numbers
};

}  // namespace raymeter
