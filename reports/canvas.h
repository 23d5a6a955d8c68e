#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "reports/colour_map.h"

namespace raymeter {

/// A picture of 8-bit sRGB pixels, row by row from the upper left corner, that can be written on.
class Canvas {
 public:
  Canvas(std::uint32_t width, std::uint32_t height, Rgb8 background);

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

  Rgb8 at(std::uint32_t x, std::uint32_t y) const;
  /// What lies outside the canvas is not drawn.
  void set(std::int64_t x, std::int64_t y, Rgb8 colour);
  void fill(std::int64_t x, std::int64_t y, std::uint32_t width, std::uint32_t height, Rgb8 colour);
  void paste(std::int64_t x, std::int64_t y, const Canvas& picture);

  /// Letters of our own, 5x7 dots in a field of text_width x text_height, `scale` times as large; (x, y) is
  /// the upper left corner of the first field. What is not printable ASCII is shown as a box.
  void write(std::int64_t x, std::int64_t y, std::string_view text, Rgb8 colour, std::uint32_t scale = 1);
  static constexpr std::uint32_t text_width = 6, text_height = 10;

 private:
  std::uint32_t width_, height_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace raymeter
