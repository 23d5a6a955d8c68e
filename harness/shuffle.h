#pragma once
#include <utility>
#include <vector>

#include "scenes/base/random.h"

namespace raymeter {

/// Puts `items` in an order that depends on `random` alone (Fisher & Yates; Durstenfeld 1964). At most 2^32.
template <class T>
void shuffle(std::vector<T>& items, Random random) {
  for (std::size_t n = items.size(); n > 1; --n)
    std::swap(items[n - 1], items[random.below(static_cast<std::uint32_t>(n))]);
}

}  // namespace raymeter
