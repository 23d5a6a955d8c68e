#include "reports/rendering_pictures.h"

#include <fmt/format.h>

#include <limits>

#include "harness/environment.h"
#include "scenes/base/version.h"

namespace raymeter {
namespace {

/// A layer of floats: values(i) gives the channels of pixel i.
template <class Values>
PictureLayer float_layer(std::string name, std::vector<std::string> channels, std::size_t pixels,
                         const Values& values) {
  PictureLayer layer{std::move(name), std::move(channels), {}};
  layer.floats.reserve(pixels * layer.channels.size());
  for (std::size_t i = 0; i < pixels; ++i)
    for (const float value : values(i)) layer.floats.push_back(value);
  return layer;
}

std::array<float, 3> channels_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

Canvas colour_picture(const Rendering& rendering) {
  Canvas canvas(rendering.columns, rendering.rows, {0, 0, 0});
  for (std::uint32_t y = 0; y < rendering.rows; ++y)
    for (std::uint32_t x = 0; x < rendering.columns; ++x) {
      const Vec3d& light = rendering.pixels[std::size_t{y} * rendering.columns + x].colour;
      canvas.set(x, y, {srgb_encoded(light.x), srgb_encoded(light.y), srgb_encoded(light.z)});
    }
  return canvas;
}

LayeredPicture rendering_layers(const Rendering& rendering, PictureMetadata metadata) {
  const auto& pixels = rendering.pixels;
  const std::size_t count = pixels.size();
  LayeredPicture picture{rendering.columns, rendering.rows, {}, std::move(metadata)};
  picture.layers.push_back(float_layer("colour", {"R", "G", "B"}, count, [&](std::size_t i) {
    return channels_of(to_float(pixels[i].colour));
  }));
  picture.layers.push_back(float_layer("depth", {"Z"}, count, [&](std::size_t i) {
    const Hit& hit = pixels[i].hit;  // primary directions are unit vectors
    return std::array{hit.found() ? hit.t : std::numeric_limits<float>::infinity()};
  }));
  picture.layers.push_back(float_layer("normal", {"normal.X", "normal.Y", "normal.Z"}, count,
                                       [&](std::size_t i) { return channels_of(pixels[i].normal); }));
  PictureLayer primitive{"primitive", {"primitive.id"}, {}};
  for (const WhittedPixel& pixel : pixels) primitive.integers.push_back(pixel.hit.primitive);
  picture.layers.push_back(std::move(primitive));

  if (rendering.work.empty()) return picture;
  const std::pair<const char*, std::uint64_t PixelWork::*> counters[] = {
      {"steps", &PixelWork::steps},
      {"empty_steps", &PixelWork::empty_cell_steps},
      {"tests", &PixelWork::tests},
      {"distinct_tests", &PixelWork::distinct_tests}};
  for (const auto& [name, counter] : counters)
    picture.layers.push_back(float_layer(
        name, {fmt::format("{}.count", name)}, count,
        [&, c = counter](std::size_t i) { return std::array{static_cast<float>(rendering.work[i].*c)}; }));
  return picture;
}

PictureMetadata rendering_metadata(const Scene& scene, const std::string& spec, const Rendering& rendering) {
  std::uint64_t rays = 0;
  for (const RayCount& count : rendering.rays) rays += count.rays;
  return {{"Software", "Raymeter " RAYMETER_VERSION},
          {"raymeter.scene", scene.name()},
          {"raymeter.scene_hash", fmt::format("{:016x}", scene.hash())},
          {"raymeter.spec", spec},
          {"raymeter.rays", fmt::format("{}", rays)},
          {"raymeter.ray_hash", fmt::format("{:016x}", rendering.ray_hash)},
          {"raymeter.version", RAYMETER_VERSION},
          {"raymeter.build_id", fmt::format("{:016x}", build_id())}};
}

}  // namespace raymeter
