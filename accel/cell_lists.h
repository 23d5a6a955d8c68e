#pragma once
#include <cstdint>
#include <span>

#include "accel/memory_meter.h"

namespace raymeter {

/// Which primitives each cell holds, in two arrays without a pointer or an allocation for any cell
/// (Lagae & Dutre, "Compact, Fast and Robust Grids for Ray Tracing", 2008): the references of cell c are
/// references[offsets[c]] .. references[offsets[c + 1] - 1].
class CellLists {
 public:
  explicit CellLists(MemoryMeter& meter)
      : offsets_(MeteredAllocator<std::uint32_t>(meter)),
        references_(MeteredAllocator<std::uint32_t>(meter)) {}

  /// Fills the lists of `cells` cells. `enumerate(add)` must call add(cell, primitive) for each pair, and is
  /// run twice; a list holds its primitives in the order of the calls. Takes time linear in cells and pairs.
  /// Throws Error for 2^32 pairs and more, MemoryLimitExceeded.
  template <class Enumerate>
  void build(std::uint64_t cells, const Enumerate& enumerate) {
    // Count what each cell will hold.
    offsets_.assign(cells + 1, 0);
    enumerate([this](std::uint64_t cell, std::uint32_t) { ++offsets_[cell]; });
    // Let each list begin where the one before it ends.
    references_.resize(counts_to_beginnings());
    // Fill; every offset moves from its list's beginning to its end, which is the next one's beginning.
    enumerate(
        [this](std::uint64_t cell, std::uint32_t primitive) { references_[offsets_[cell]++] = primitive; });
    ends_to_beginnings();
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
  std::uint64_t counts_to_beginnings();
  void ends_to_beginnings();

  MeteredVector<std::uint32_t> offsets_, references_;
};

}  // namespace raymeter
