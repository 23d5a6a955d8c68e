#pragma once
// What one thread makes of a tree of bricks, until its place among all is known.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>

#include "accel/brick_rules.h"
#include "accel/bricks.h"
#include "accel/memory_meter.h"
#include "scenes/base/error.h"

namespace raymeter {

/// Nodes and words that 32 bits can number.
inline constexpr std::uint64_t most_numbered = std::numeric_limits<std::uint32_t>::max();
[[noreturn]] inline void refuse_bricks() {
  throw Error("brick-grid: more than 16 GiB of leaves");
}

/// Nodes and leaves, with places of their own. Of leaves first only what is in them: their words are written
/// when it is known how many there are before them. Threads make neighbouring parts at the same time: none
/// shares a line of the cache with the next, nor the pair of lines that is fetched together.
template <class Primitives>
struct alignas(2 * cache_line) Part {
  struct Leaf {
    std::uint32_t triangles, others;
  };

  Part(const Primitives& none, MemoryMeter& meter)
      : all(none),
        nodes(MeteredAllocator<BrickNode>(meter)),
        leaves(MeteredAllocator<Leaf>(meter)),
        masks(MeteredAllocator<std::uint64_t>(meter)),
        primitives(MeteredAllocator<std::uint32_t>(meter)) {}

  Primitives all;
  MeteredVector<BrickNode> nodes;
  MeteredVector<Leaf> leaves;
  MeteredVector<std::uint64_t> masks;       // of leaf after leaf, as LeafWords has them
  MeteredVector<std::uint32_t> primitives;  // of leaf after leaf, as `all` numbers them
  std::uint64_t words = 0;
  std::uint32_t depth = 0;

  /// Of triangles in the order in which they are to be tested; `cells`: of each.
  void make_leaf(BrickNode& leaf, std::span<const std::uint32_t> triangles,
                 std::span<const std::uint64_t> cells, std::span<const std::uint32_t> others) {
    words = LeafWords::begin(words, triangles.size());
    leaf.base = static_cast<std::uint32_t>(words);
    leaf.triangles = static_cast<std::uint32_t>(triangles.size());
    leaf.others = static_cast<std::uint32_t>(others.size());
    leaves.push_back({leaf.triangles, leaf.others});
    primitives.insert(primitives.end(), triangles.begin(), triangles.end());
    primitives.insert(primitives.end(), others.begin(), others.end());
    if (LeafWords::has_masks(leaf.triangles))
      for (std::size_t first = 0; first < triangles.size(); first += LeafWords::block) {
        std::uint64_t mask = 0;
        for (std::size_t i = first; i < std::min(triangles.size(), first + LeafWords::block); ++i)
          mask |= cells[i];
        masks.push_back(mask);
      }
    words += LeafWords::count(leaf.triangles) + others.size();
    if (words > most_numbered) refuse_bricks();
  }

  /// Where the words of another part may begin.
  std::uint64_t end_of_words() const { return LeafWords::begin(words, LeafWords::block); }

  /// Writes the words of all leaves, at their place.
  void write_leaves(std::uint32_t* first) const {
    std::uint32_t* to = first;
    const std::uint32_t* next = primitives.data();
    const std::uint64_t* mask = masks.data();
    for (const Leaf& leaf : leaves) {
      std::uint32_t* const begin =
          first + LeafWords::begin(static_cast<std::uint64_t>(to - first), leaf.triangles);
      to = std::fill_n(to, begin - to, 0u);
      for (std::uint32_t i = 0; i < leaf.triangles; ++i)
        LeafWords::put(to, leaf.triangles, i, all.triangle(next[i]), all.primitive(next[i]));
      next += leaf.triangles;
      to += TriangleRows::rows * leaf.triangles;
      for (std::size_t i = 0; i < LeafWords::masks(leaf.triangles); ++i, ++mask) {
        *to++ = static_cast<std::uint32_t>(*mask);
        *to++ = static_cast<std::uint32_t>(*mask >> 32u);
      }
      to = std::transform(next, next + leaf.others, to, [&](std::uint32_t p) { return all.primitive(p); });
      next += leaf.others;
    }
    std::fill(to, first + end_of_words(), 0u);
  }
};

/// Sorts a leaf's triangles so that neighbours in the array are neighbours in space.
class LeafOrder {
 public:
  explicit LeafOrder(MemoryMeter& meter)
      : triangles_(MeteredAllocator<std::uint32_t>(meter)), cells_(MeteredAllocator<std::uint64_t>(meter)) {}

  /// By the first of the cells that they meet, along a Z-order curve (Morton 1966).
  void sort(std::span<std::uint32_t> triangles, std::span<std::uint64_t> cells) {
    if (!LeafWords::has_masks(triangles.size())) return;
    triangles_.assign(triangles.begin(), triangles.end());
    cells_.assign(cells.begin(), cells.end());
    CellCounts counts{}, places;
    for (const std::uint64_t mask : cells_) ++counts[key(mask)];
    std::exclusive_scan(counts.begin(), counts.end(), places.begin(), 0u);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t place = places[key(cells_[i])]++;
      triangles[place] = triangles_[i];
      cells[place] = cells_[i];
    }
  }

 private:
  static constexpr std::array<std::uint8_t, 64> z_order() {
    std::array<std::uint8_t, 64> order{};
    for (unsigned cell = 0; cell < 64; ++cell)
      for (unsigned axis = 0; axis < 3; ++axis)
        order[cell] = static_cast<std::uint8_t>(order[cell] | (cell >> (2 * axis) & 1u) << axis |
                                                (cell >> (2 * axis + 1) & 1u) << (axis + 3));
    return order;
  }
  static std::size_t key(std::uint64_t mask) {
    static constexpr auto order = z_order();
    return order[static_cast<unsigned>(std::countr_zero(mask | std::uint64_t{1} << 63u))];
  }

  MeteredVector<std::uint32_t> triangles_;  // as they were, and their cells
  MeteredVector<std::uint64_t> cells_;
};

}  // namespace raymeter
