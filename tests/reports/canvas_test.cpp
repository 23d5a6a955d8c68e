#include "reports/canvas.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace raymeter {
namespace {

constexpr Rgb8 white{255, 255, 255}, black{0, 0, 0}, red{255, 0, 0};

/// The dots of a text, as lines of # and blanks.
std::string dots(std::string_view text, std::uint32_t width, std::uint32_t height, std::uint32_t scale = 1) {
  Canvas canvas(width, height, white);
  canvas.write(0, 0, text, black, scale);
  std::string lines;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) lines += canvas.at(x, y) == black ? '#' : ' ';
    lines += '\n';
  }
  return lines;
}

TEST(Canvas, WritesLetters) {
  EXPECT_EQ(dots("F1", 12, 8),
            "#####   #   \n"
            "#      ##   \n"
            "#       #   \n"
            "####    #   \n"
            "#       #   \n"
            "#       #   \n"
            "#      ###  \n"
            "            \n");
  EXPECT_EQ(dots("-", 12, 16, 2).substr(6 * 13, 13), "##########  \n");
}

TEST(Canvas, EveryLetterIsAnother) {
  std::set<std::string> seen;
  for (char letter = ' '; letter <= '~'; ++letter) seen.insert(dots(std::string(1, letter), 6, 8));
  EXPECT_EQ(seen.size(), 95u);
  EXPECT_EQ(dots("\xc3", 6, 8), dots("\n", 6, 8));  // a box
  EXPECT_EQ(seen.count(dots("\n", 6, 8)), 0u);
}

TEST(Canvas, CutsOffWhatLiesOutside) {
  Canvas canvas(4, 3, white);
  canvas.fill(-2, -2, 100, 3, red);
  canvas.write(3, 2, "M", black);
  canvas.paste(2, 1, Canvas(50, 50, black));
  canvas.set(-1, 0, black);
  canvas.set(0, 3, black);
  EXPECT_EQ(canvas.at(0, 0), red);
  EXPECT_EQ(canvas.at(0, 1), white);
  EXPECT_EQ(canvas.at(2, 1), black);
  EXPECT_EQ(canvas.at(1, 2), white);
  EXPECT_EQ(canvas.bytes().size(), 36u);
}

}  // namespace
}  // namespace raymeter
