#pragma once
#include <cstdint>
#include <vector>

#include "accel/structure.h"

namespace raymeter {

/// Where a picture is sampled: once for each pixel.
struct PictureSize {
  std::uint32_t width = 320, height = 240;
  /// Rays go through the corners of pixels, (width + 1) x (height + 1) of them, that span exactly the
  /// camera's angle (the convention of the SPD: 513 x 513 rays for 512 x 512); otherwise through pixel
  /// centres.
  bool pixel_corners = false;

  std::uint32_t columns() const { return width + (pixel_corners ? 1 : 0); }
  std::uint32_t rows() const { return height + (pixel_corners ? 1 : 0); }
};

/// The pixels (row * columns + column, row 0 on top) in the order in which their rays are traced. Tiled:
/// tiles of 8x8 row by row, in a tile along Morton's curve, so that 4, 8, 16 neighbours in the order are a
/// block of 2x2, 4x2, 4x4 pixels: packets get what suits them best. Shuffled: by Fisher and Yates, from
/// `seed`.
std::vector<std::uint32_t> pixel_order(const PictureSize& size, RayOrder order, std::uint64_t seed);

}  // namespace raymeter
