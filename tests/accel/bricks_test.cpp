#include "accel/bricks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/memory_meter.h"

namespace raymeter {
namespace {

Triangle numbered(std::uint32_t i) {
  const auto x = static_cast<float>(i);
  return {{x, 0.5f, 1}, {x + 1, 2, 3}, {x + 0.25f, 4, 5}};
}

TEST(LeafWords, GiveBackWhatWasPut) {
  for (const std::uint32_t count : {1u, 15u, 16u, 17u, 32u, 33u}) {
    EXPECT_EQ(LeafWords::masks(count), count <= 16 ? 0u : (count + 15) / 16);
    std::vector<std::uint32_t> words(LeafWords::count(count), 0xdeadbeefu);
    for (std::uint32_t i = 0; i < count; ++i) LeafWords::put(words.data(), count, i, numbered(i), 1000 + i);
    for (std::size_t i = 0; i < LeafWords::masks(count); ++i) {
      words[TriangleRows::rows * count + 2 * i] = static_cast<std::uint32_t>(i);
      words[TriangleRows::rows * count + 2 * i + 1] = 7;
    }
    for (std::uint32_t first = 0; first < count; first += 16) {
      const TriangleRows block = LeafWords::rows(words.data(), count, first);
      ASSERT_EQ(block.count, std::min(16u, count - first));
      for (std::uint32_t i = 0; i < block.count; ++i) {
        const Triangle triangle = block.triangle(i), expected = numbered(first + i);
        EXPECT_EQ(triangle.a, expected.a);
        EXPECT_EQ(triangle.b, expected.b);
        EXPECT_EQ(triangle.c, expected.c);
        EXPECT_EQ(block.primitive(i), 1000 + first + i);
        EXPECT_GE(block.edge(i), 1 + 1.5f + 2) << "the 1-norm of b - a";
      }
      EXPECT_EQ(LeafWords::cells(words.data(), count, first),
                count <= 16 ? ~std::uint64_t{0} : std::uint64_t{7} << 32u | first / 16);
    }
    EXPECT_EQ(std::ranges::count(words, 0xdeadbeefu), 0) << "all words are in use";
  }
  EXPECT_EQ(LeafWords::count(0), 0u);
}

TEST(LeafWords, WholeBlocksBeginWithALineOfTheCache) {
  EXPECT_EQ(LeafWords::begin(5, 15), 5u);
  EXPECT_EQ(LeafWords::begin(5, 16), 16u);
  EXPECT_EQ(LeafWords::begin(16, 40), 16u);
  EXPECT_EQ(LeafWords::begin(17, 40), 32u);
  MemoryMeter meter;
  for (const std::size_t size : {1u, 100u, 3'000'000u}) {
    const MeteredVector<std::uint32_t> words(size, 0u, MeteredAllocator<std::uint32_t>(meter));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(words.data()) % cache_line, 0u);
    EXPECT_EQ(meter.bytes(), 4 * size);
  }
  EXPECT_EQ(meter.bytes(), 0u);
}

}  // namespace
}  // namespace raymeter
