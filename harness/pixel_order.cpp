#include "harness/pixel_order.h"

#include "harness/shuffle.h"

namespace raymeter {
namespace {

constexpr std::uint32_t tile = 8;

/// Every second bit of a tile's running number, beginning with bit `first`: a coordinate on Morton's curve.
constexpr std::uint32_t deinterleave(std::uint32_t number, std::uint32_t first) {
  number >>= first;
  return (number & 1u) | ((number >> 1u) & 2u) | ((number >> 2u) & 4u);
}

}  // namespace

std::vector<std::uint32_t> pixel_order(const PictureSize& size, RayOrder order, std::uint64_t seed) {
  const std::uint32_t columns = size.columns(), rows = size.rows();
  std::vector<std::uint32_t> pixels;
  pixels.reserve(std::size_t{columns} * rows);
  if (order == RayOrder::tiled) {
    for (std::uint32_t top = 0; top < rows; top += tile)
      for (std::uint32_t left = 0; left < columns; left += tile)
        for (std::uint32_t number = 0; number < tile * tile; ++number) {
          const std::uint32_t x = left + deinterleave(number, 0), y = top + deinterleave(number, 1);
          if (x < columns && y < rows) pixels.push_back(y * columns + x);
        }
  } else {
    for (std::uint32_t i = 0; i < columns * rows; ++i) pixels.push_back(i);
    if (order == RayOrder::shuffled) shuffle(pixels, Random(seed, 1));
  }
  return pixels;
}

}  // namespace raymeter
