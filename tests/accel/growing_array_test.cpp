#include "accel/growing_array.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace raymeter {
namespace {

using Array = GrowingArray<std::uint32_t>;

/// Adds elements up to n: squares.
void grow(Array& array, std::uint32_t n) {
  auto i = static_cast<std::uint32_t>(array.size());
  array.grow(n);
  for (; i < n; ++i) array[i] = i * i;
}
void expect_squares(const Array& array, std::uint32_t n) {
  ASSERT_EQ(array.size(), n);
  std::uint32_t i = 0;
  for (const std::uint32_t square : array) {
    ASSERT_EQ(square, i * i);
    ++i;
  }
}

TEST(GrowingArray, StaysWhereItIsInTheSpaceSetAside) {
  MemoryMeter meter;
  {
    Array array(meter);
    if (!array.set_aside(std::size_t{1} << 32u)) GTEST_SKIP() << "the system refuses";
    EXPECT_EQ(meter.bytes(), 0u);
    const std::uint32_t* const data = array.data();
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(data) % cache_line, 0u);
    for (const std::uint32_t n : {1u, 1000u, 1000u, 3000000u}) {
      grow(array, n);
      EXPECT_EQ(array.data(), data);
      EXPECT_EQ(meter.bytes(), 4 * n);
      EXPECT_EQ(array.bytes(), 4 * n);
    }
    array.give_back();
    EXPECT_EQ(array.data(), data);
    ASSERT_NO_FATAL_FAILURE(expect_squares(array, 3000000));
    // Beyond what is left.
    grow(array, 3100000);
    ASSERT_NO_FATAL_FAILURE(expect_squares(array, 3100000));
    EXPECT_EQ(meter.bytes(), 4u * 3100000);
  }
  EXPECT_EQ(meter.bytes(), 0u);
}

TEST(GrowingArray, MovesWhereNothingWasSetAside) {
  MemoryMeter meter;
  {
    Array array(meter);
    array.give_back();
    grow(array, 1000);
    EXPECT_EQ(meter.peak(), 4000u);
    grow(array, 3000);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % cache_line, 0u);
    EXPECT_EQ(meter.bytes(), 12000u);
    EXPECT_EQ(meter.peak(), 16000u);
    array.give_back();
    ASSERT_NO_FATAL_FAILURE(expect_squares(array, 3000));
  }
  EXPECT_EQ(meter.bytes(), 0u);
}

TEST(GrowingArray, StaysAsItWasWhereTheLimitIsExceeded) {
  for (const bool aside : {false, true}) {
    MemoryMeter meter(10000);
    {
      Array array(meter);
      if (aside && !array.set_aside(1000000)) continue;
      grow(array, 1000);
      EXPECT_THROW(array.grow(2600), MemoryLimitExceeded);
      ASSERT_NO_FATAL_FAILURE(expect_squares(array, 1000));
      EXPECT_EQ(meter.bytes(), 4000u);
    }
    EXPECT_EQ(meter.bytes(), 0u);
  }
}

}  // namespace
}  // namespace raymeter
