#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "reports/canvas.h"

namespace raymeter {

/// Names and texts that a picture file carries along.
using PictureMetadata = std::vector<std::pair<std::string, std::string>>;

/// One layer of a picture: channels of one type, pixel by pixel, row by row from the upper left corner.
struct PictureLayer {
  std::string name;
  std::vector<std::string> channels;
  std::vector<float> floats;              ///< the values, or empty where there are
  std::vector<std::uint32_t> integers{};  ///< whole numbers instead
};

/// Layers of the same width and height.
struct LayeredPicture {
  std::uint32_t width = 0, height = 0;
  std::vector<PictureLayer> layers;
  PictureMetadata metadata;
};

/// Writes an 8-bit sRGB PNG. It appears under its name when it is complete (see AtomicFile). These functions
/// are what loads OpenImageIO, with 260 libraries of its own, into the process. They throw Error when the
/// file can't be written.
void write_png(const std::filesystem::path& file, const Canvas& picture, const PictureMetadata& metadata);

/// Writes an OpenEXR file of one part for each layer, ZIP-compressed; the metadata is in all parts.
void write_exr(const std::filesystem::path& file, const LayeredPicture& picture);

}  // namespace raymeter
