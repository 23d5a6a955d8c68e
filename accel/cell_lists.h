#pragma once
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>

#include "accel/memory_meter.h"
#include "accel/parallel.h"

namespace raymeter {

/// Which primitives each cell holds, in two arrays without a pointer or an allocation for any cell
/// (Lagae & Dutre, "Compact, Fast and Robust Grids for Ray Tracing", 2008): the references of cell c are
/// references[offsets[c]] .. references[offsets[c + 1] - 1].
class CellLists {
 public:
  explicit CellLists(MemoryMeter& meter)
      : offsets_(MeteredAllocator<std::uint32_t>(meter)),
        references_(RawMeteredAllocator<std::uint32_t>(meter)) {}

  /// Fills the lists of `cells` cells: enumerate(primitive, add) must call add(cell) for each cell that is to
  /// hold the primitive, and is run twice for each of `primitives`, on several threads. Every list holds its
  /// primitives in ascending order. Takes time linear in cells, primitives and pairs (a crowded list that
  /// several threads filled is sorted besides). Throws Error for 2^32 pairs and more, MemoryLimitExceeded.
  template <class Enumerate>
  void build(std::uint64_t cells, std::uint64_t primitives, const Enumerate& enumerate) {
    const bool shared = is_parallel();
    const auto next = [this, shared](std::uint64_t cell) {
      std::uint32_t& place = next_of(cell);
      return shared ? std::atomic_ref(place).fetch_add(1, std::memory_order_relaxed) : place++;
    };
    build_in_two_passes(cells, [&](const auto& each) {
      for_ranges(primitives, 1024, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t p = begin; p < end; ++p)
          enumerate(static_cast<std::uint32_t>(p),
                    [&](std::uint64_t cell) { each(next(cell), static_cast<std::uint32_t>(p)); });
      });
    });
    if (shared) sort_lists();
  }

  /// The same by groups of cells that share none: enumerate(group, add) calls add(cell, primitive) for each
  /// pair of the group's cells. A list holds its primitives in the order of the calls.
  template <class Enumerate>
  void build_by_groups(std::uint64_t cells, std::uint64_t groups, const Enumerate& enumerate) {
    build_in_two_passes(cells, [&](const auto& each) {
      for_ranges(groups, 16, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t group = begin; group < end; ++group)
          enumerate(group, [&](std::uint64_t cell, std::uint32_t p) { each(next_of(cell)++, p); });
      });
    });
  }

  /// The same by stretches of fewer than 2^32 cells, one for each thread: enumerate(begin, end, add) calls
  /// add(cell, primitive) for each pair of the cells begin .. end - 1. A list holds its primitives in the
  /// order of the calls.
  template <class Enumerate>
  void build_by_stretches(std::uint64_t cells, const Enumerate& enumerate) {
    const auto stretches = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
    build_in_two_passes(cells, [&](const auto& each) {
      for_ranges(stretches, 1, [&](std::uint64_t begin, std::uint64_t end) {
        std::uint32_t* const next = offsets_.data() + 1;
        for (std::uint64_t s = begin; s < end; ++s)
          enumerate(static_cast<std::uint32_t>(cells * s / stretches),
                    static_cast<std::uint32_t>(cells * (s + 1) / stretches),
                    [&](std::uint64_t cell, std::uint32_t p) { each(next[cell]++, p); });
      });
    });
  }

  /// Empties the lists of the cells where is_dropped(cell), and gives their memory back.
  template <class IsDropped>
  void drop(const IsDropped& is_dropped) {
    std::uint32_t kept = 0, begin = 0;
    for (std::uint64_t c = 0; c < cells(); ++c) {
      const std::uint32_t end = offsets_[c + 1];
      if (!is_dropped(c))
        for (std::uint32_t r = begin; r < end; ++r) references_[kept++] = references_[r];
      begin = end;
      offsets_[c + 1] = kept;
    }
    references_.resize(kept);
    references_.shrink_to_fit();
  }

  std::span<const std::uint32_t> operator[](std::uint64_t cell) const {
    return {references_.data() + offsets_[cell], references_.data() + offsets_[cell + 1]};
  }
  std::uint64_t cells() const { return offsets_.empty() ? 0 : offsets_.size() - 1; }
  std::uint64_t references() const { return references_.size(); }
  std::uint64_t empty_cells() const;
  std::uint64_t offset_bytes() const { return offsets_.capacity() * sizeof(std::uint32_t); }
  std::uint64_t reference_bytes() const { return references_.capacity() * sizeof(std::uint32_t); }

 private:
  /// run(each) must add one to next_of(cell) for each pair, and call each(its old value, primitive).
  template <class Run>
  void build_in_two_passes(std::uint64_t cells, const Run& run) {
    // Count what each cell will hold.
    offsets_.assign(cells + 1, 0);
    run([](std::uint32_t, std::uint32_t) {});
    // Let each list begin where the one before it ends.
    references_.resize(counts_to_beginnings());
    // Fill; every list's next place moves from its beginning to its end, which is the next list's beginning.
    run([to = references_.data()](std::uint32_t place, std::uint32_t primitive) { to[place] = primitive; });
  }
  /// While building: how many primitives the cell is known to hold, then where the next of them goes.
  std::uint32_t& next_of(std::uint64_t cell) { return offsets_[cell + 1]; }

  void sort_lists();
  std::uint64_t counts_to_beginnings();

  MeteredVector<std::uint32_t> offsets_;
  RawMeteredVector<std::uint32_t> references_;
};

}  // namespace raymeter
