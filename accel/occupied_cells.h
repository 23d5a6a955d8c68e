#pragma once
#include <atomic>
#include <bit>
#include <cstdint>

#include "accel/memory_meter.h"

namespace raymeter {

/// A set of cells that numbers its members, so that what is kept of them can lie side by side: most cells of
/// a fine grid hold nothing. A bit a cell, and for each word of bits how many members lie before it (the rank
/// directory of Jacobson, "Space-efficient Static Trees and Graphs", 1989): 12 bytes for 64 cells.
class OccupiedCells {
 public:
  explicit OccupiedCells(MemoryMeter& meter)
      : words_(MeteredAllocator<std::uint64_t>(meter)), before_(RawMeteredAllocator<std::uint32_t>(meter)) {}

  /// None of so many cells.
  void reset(std::uint64_t cells) {
    cells_ = cells;
    words_.clear();
    words_.shrink_to_fit();
    words_.assign((cells + word_bits - 1) / word_bits, 0);
  }
  /// Adds first .. first + count - 1. `shared`: several threads may do so at once.
  void insert(std::uint64_t first, std::uint64_t count, bool shared) {
    // Mostly in one word.
    while (first % word_bits + count > word_bits) {
      const std::uint64_t part = word_bits - first % word_bits;
      insert_in_word(first, part, shared);
      first += part;
      count -= part;
    }
    insert_in_word(first, count, shared);
  }
  /// Numbers the members in ascending order, after all were added. Gives how many there are.
  std::uint32_t number();

  std::uint64_t cells() const { return cells_; }
  bool contains(std::uint64_t cell) const { return words_[cell / word_bits] >> cell % word_bits & 1u; }
  /// Of a member. Those of members side by side follow each other.
  std::uint32_t number_of(std::uint64_t cell) const {
    return before_[cell / word_bits] +
           population(words_[cell / word_bits] & ~(~std::uint64_t{0} << cell % word_bits));
  }
  std::uint64_t bytes() const {
    return words_.capacity() * sizeof(std::uint64_t) + before_.capacity() * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint64_t word_bits = 64;

  void insert_in_word(std::uint64_t first, std::uint64_t count, bool shared) {
    const std::uint64_t mask = ~std::uint64_t{0} >> (word_bits - count) << first % word_bits;
    std::uint64_t& bits = words_[first / word_bits];
    if (!shared)
      bits |= mask;
    else if (std::atomic_ref word(bits); (word.load(std::memory_order_relaxed) & mask) != mask)
      word.fetch_or(mask, std::memory_order_relaxed);
  }

  static std::uint32_t population(std::uint64_t bits) {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__POPCNT__)
    // std::popcount calls a function, for the oldest CPUs have no such instruction. All that one meets have
    // it.
    if (__builtin_cpu_supports("popcnt")) {
      std::uint64_t count;
      asm("popcnt %1, %0" : "=r"(count) : "rm"(bits) : "cc");
      return static_cast<std::uint32_t>(count);
    }
#endif
    return static_cast<std::uint32_t>(std::popcount(bits));
  }

  std::uint64_t cells_ = 0;
  MeteredVector<std::uint64_t> words_;
  RawMeteredVector<std::uint32_t> before_;  // each word
};

}  // namespace raymeter
