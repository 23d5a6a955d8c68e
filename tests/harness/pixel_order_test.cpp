#include "harness/pixel_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace raymeter {
namespace {

TEST(PixelOrder, EveryOrderHasEveryPixelOnce) {
  for (const bool corners : {false, true})
    for (const std::uint32_t width : {1u, 7u, 8u, 16u, 21u})
      for (const std::uint32_t height : {1u, 8u, 13u}) {
        const PictureSize size{width, height, corners};
        std::vector<std::uint32_t> all(size.columns() * size.rows());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(pixel_order(size, RayOrder::scanline, 1), all);
        for (const RayOrder order : {RayOrder::tiled, RayOrder::shuffled}) {
          auto pixels = pixel_order(size, order, 1);
          std::ranges::sort(pixels);
          EXPECT_EQ(pixels, all);
        }
      }
}

TEST(PixelOrder, PacketsOfATileAreBlocks) {
  const auto pixels = pixel_order({16, 16}, RayOrder::tiled, 1);
  const auto first = [&](std::size_t n) {
    return std::vector<std::uint32_t>(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(n));
  };
  EXPECT_THAT(first(4), testing::ElementsAre(0, 1, 16, 17));
  EXPECT_THAT(first(8), testing::ElementsAre(0, 1, 16, 17, 2, 3, 18, 19));
  EXPECT_EQ(first(16).back(), 3u * 16 + 3);
  EXPECT_EQ(pixels[64], 8u);
  EXPECT_EQ(pixels[128], 8u * 16);
}

TEST(PixelOrder, ShufflesDifferBySeed) {
  const PictureSize size{20, 20};
  EXPECT_EQ(pixel_order(size, RayOrder::shuffled, 5), pixel_order(size, RayOrder::shuffled, 5));
  EXPECT_NE(pixel_order(size, RayOrder::shuffled, 5), pixel_order(size, RayOrder::shuffled, 6));
}

}  // namespace
}  // namespace raymeter
