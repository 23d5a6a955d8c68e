#include "accel/cell_lists.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/base/error.h"

namespace raymeter {

std::uint64_t CellLists::empty_cells() const {
  return sum_of_ranges<std::uint64_t>(cells(), 65536, [this](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t empty = 0;
    for (std::uint64_t c = begin; c < end; ++c) empty += offsets_[c] == offsets_[c + 1];
    return empty;
  });
}

void CellLists::sort_lists() {
  for_ranges(cells(), 4096, [this](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c)
      std::sort(references_.begin() + offsets_[c], references_.begin() + offsets_[c + 1]);
  });
}

std::uint64_t CellLists::counts_to_beginnings() {
  std::uint64_t total = 0;
  for (auto& offset : offsets_) {
    const std::uint32_t count = offset;
    offset = static_cast<std::uint32_t>(total);
    total += count;
  }
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error(fmt::format(
        "{} references from cells to primitives are more than 32 bits can number; choose fewer cells",
        total));
  return total;
}

}  // namespace raymeter
