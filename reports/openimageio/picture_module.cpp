#include "reports/openimageio/picture_module.h"

#include <OpenImageIO/imageio.h>

#include <memory>

namespace {

using raymeter::Canvas;
using raymeter::LayeredPicture;
using raymeter::PictureLayer;
using raymeter::PictureMetadata;

std::string complaint(const OIIO::ImageOutput* output) {
  const std::string text = output ? output->geterror() : OIIO::geterror();
  return text.empty() ? "OpenImageIO does not say why" : text;
}

void add_metadata(OIIO::ImageSpec& spec, const PictureMetadata& metadata) {
  for (const auto& [name, text] : metadata) spec.attribute(name, text);
}

OIIO::ImageSpec spec_of(const LayeredPicture& picture, const PictureLayer& layer) {
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height),
                       static_cast<int>(layer.channels.size()),
                       layer.integers.empty() ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT32);
  spec.channelnames = layer.channels;
  spec.attribute("oiio:subimagename", layer.name);
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  add_metadata(spec, picture.metadata);
  return spec;
}

std::string try_to_write_png(const std::string& file, const Canvas& picture,
                             const PictureMetadata& metadata) {
  const auto output = OIIO::ImageOutput::create("png");
  if (!output) return complaint(nullptr);
  OIIO::ImageSpec spec(static_cast<int>(picture.width()), static_cast<int>(picture.height()), 3,
                       OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("png:compressionLevel", 9);
  add_metadata(spec, metadata);
  if (!output->open(file, spec) || !output->write_image(OIIO::TypeDesc::UINT8, picture.bytes().data()) ||
      !output->close())
    return complaint(output.get());
  return {};
}

std::string try_to_write_exr(const std::string& file, const LayeredPicture& picture) {
  const auto output = OIIO::ImageOutput::create("openexr");
  if (!output) return complaint(nullptr);
  std::vector<OIIO::ImageSpec> specs;
  for (const PictureLayer& layer : picture.layers) specs.push_back(spec_of(picture, layer));
  if (!output->open(file, static_cast<int>(specs.size()), specs.data())) return complaint(output.get());
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (i > 0 && !output->open(file, specs[i], OIIO::ImageOutput::AppendSubimage))
      return complaint(output.get());
    const PictureLayer& layer = picture.layers[i];
    const bool written = layer.integers.empty()
                             ? output->write_image(OIIO::TypeDesc::FLOAT, layer.floats.data())
                             : output->write_image(OIIO::TypeDesc::UINT32, layer.integers.data());
    if (!written) return complaint(output.get());
  }
  return output->close() ? std::string() : complaint(output.get());
}

}  // namespace

extern "C" void raymeter_write_png(const std::string& file, const Canvas& picture,
                                   const PictureMetadata& metadata, std::string& failure) {
  failure = try_to_write_png(file, picture, metadata);
}

extern "C" void raymeter_write_exr(const std::string& file, const LayeredPicture& picture,
                                   std::string& failure) {
  failure = try_to_write_exr(file, picture);
}
