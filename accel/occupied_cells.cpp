#include "accel/occupied_cells.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "accel/parallel.h"

namespace raymeter {

std::uint32_t OccupiedCells::number() {
  // Count the members of each block of words, then those before it, then those before each of its words.
  constexpr std::size_t block = 4096;
  before_.resize(words_.size());
  std::vector<std::uint32_t> counts((words_.size() + block - 1) / block);
  const auto for_words = [&](std::uint64_t b, const auto& use) {
    for (std::size_t w = b * block; w < std::min(words_.size(), (b + 1) * block); ++w) use(w);
  };
  for_ranges(counts.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t b = begin; b < end; ++b)
      for_words(b, [&](std::size_t w) { counts[b] += population(words_[w]); });
  });
  std::uint32_t total = 0;
  for (std::uint32_t& count : counts) total += std::exchange(count, total);
  for_ranges(counts.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t b = begin; b < end; ++b) {
      std::uint32_t before = counts[b];
      for_words(b, [&](std::size_t w) {
        before_[w] = before;
        before += population(words_[w]);
      });
    }
  });
  return total;
}

}  // namespace raymeter
