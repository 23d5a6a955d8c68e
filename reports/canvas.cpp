#include "reports/canvas.h"

#include "reports/letters.h"

namespace raymeter {

Canvas::Canvas(std::uint32_t width, std::uint32_t height, Rgb8 background)
    : width_(width), height_(height), bytes_(std::size_t{3} * width * height) {
  fill(0, 0, width, height, background);
}

Rgb8 Canvas::at(std::uint32_t x, std::uint32_t y) const {
  const std::size_t first = 3 * (std::size_t{y} * width_ + x);
  return {bytes_[first], bytes_[first + 1], bytes_[first + 2]};
}

void Canvas::set(std::int64_t x, std::int64_t y, Rgb8 colour) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  const std::size_t first = 3 * (static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x));
  for (std::size_t i = 0; i < 3; ++i) bytes_[first + i] = colour[i];
}

void Canvas::fill(std::int64_t x, std::int64_t y, std::uint32_t width, std::uint32_t height, Rgb8 colour) {
  for (std::int64_t row = y; row < y + height; ++row)
    for (std::int64_t column = x; column < x + width; ++column) set(column, row, colour);
}

void Canvas::paste(std::int64_t x, std::int64_t y, const Canvas& picture) {
  for (std::uint32_t row = 0; row < picture.height(); ++row)
    for (std::uint32_t column = 0; column < picture.width(); ++column)
      set(x + column, y + row, picture.at(column, row));
}

void Canvas::write(std::int64_t x, std::int64_t y, std::string_view text, Rgb8 colour, std::uint32_t scale) {
  for (const char character : text) {
    const Letter& letter = letter_of(character);
    for (std::size_t row = 0; row < letter.size(); ++row)
      for (unsigned column = 0; column < 5; ++column)
        if ((unsigned{letter[row]} >> (4 - column)) & 1u)
          fill(x + column * scale, y + static_cast<std::int64_t>(row) * scale, scale, scale, colour);
    x += text_width * scale;
  }
}

}  // namespace raymeter
