#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

#include "accel/memory_meter.h"
#include "accel/octree_cells.h"

namespace raymeter {

/// A node's name says how to get to it from the root. In Glassner's paper the root is 1 and the children of
/// node n are 10 n + 1 ... 10 n + 8, in decimal. Ours are the same in octal: the root is 1 and the
/// children of n are 8 n + 0 ... 8 n + 7, so that 20 levels fit in 64 bits (his: 18) and a child's name
/// is a shift and an or. Names of different levels differ by their length, as his do.
using OctreeName = std::uint64_t;
inline constexpr OctreeName octree_root_name = 1;

inline OctreeName child_name(OctreeName parent, unsigned child) {
  return parent << 3u | child;
}

/// The nodes of an octree in a hash table, by name, as Glassner keeps them. Empty leaves are not stored: a
/// child that is not found is one. (He chains the nodes of equal hash; we probe the next place, at most
/// half of the places being taken.)
class OctreeNames {
 public:
  OctreeNames(const OctreeCells& tree, MemoryMeter& meter) : entries_(MeteredAllocator<Entry>(meter)) {
    const std::uint64_t stored = tree.nodes.size() - tree.empty_leaves;
    const auto bits = std::max(1, static_cast<int>(std::bit_width(2 * stored - 1)));
    shift_ = 64 - bits;
    entries_.resize(std::size_t{1} << bits);
    add(tree, 0, octree_root_name);
  }

  /// The node of that name; an empty leaf when there is none.
  OctreeNode find(OctreeName name) const {
    for (std::size_t place = home(name);; place = (place + 1) & (entries_.size() - 1)) {
      const Entry& entry = entries_[place];
      if (entry.name == name) return entry.node;
      if (entry.name == 0) return {};
    }
  }
  std::uint64_t bytes() const { return entries_.capacity() * sizeof(Entry); }

 private:
  struct Entry {
    OctreeName name = 0;  // 0: a free place
    OctreeNode node;      // an inner node's `first` means nothing here
  };

  void add(const OctreeCells& tree, std::size_t index, OctreeName name) {
    const OctreeNode node = tree.nodes[index];
    if (node.count == 0) return;
    std::size_t place = home(name);
    while (entries_[place].name != 0) place = (place + 1) & (entries_.size() - 1);
    entries_[place] = {name, node};
    if (node.is_inner())
      for (unsigned child = 0; child < 8; ++child) add(tree, node.first + child, child_name(name, child));
  }

  /// Fibonacci hashing (Knuth, volume 3): the high bits of a product, which depend on all levels of the name.
  std::size_t home(OctreeName name) const { return (name * 0x9e3779b97f4a7c15u) >> shift_; }

  MeteredVector<Entry> entries_;
  int shift_ = 63;
};

}  // namespace raymeter
