// Pictures that the module wrote, read back.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <limits>
#include <map>

#include "reports/rendering_pictures.h"
#include "scenes/base/error.h"
#include "scenes/base/version.h"

namespace raymeter {
namespace {

std::string picture_name(const char* name) {
  return testing::TempDir() + name;
}

/// 5 x 3 pixels with other values in each; one of them missed everything.
Rendering some_rendering() {
  Rendering rendering;
  rendering.columns = 5;
  rendering.rows = 3;
  rendering.ray_hash = 0x0123456789abcdefull;
  rendering.rays = {{RayPurpose::primary, 1, 15, 14}, {RayPurpose::shadow, 1, 27, 3}};
  for (std::uint32_t i = 0; i < 15; ++i) {
    const auto x = static_cast<float>(i);
    rendering.pixels.push_back({{0.1 * i, 0.01 * i, 2.0 * i}, {10 + x, 0x01000001u + i}, {x, -x, 1}});
    rendering.work.push_back(
        {.steps = i, .empty_cell_steps = 100 + i, .tests = 200 + i, .distinct_tests = 300 + i});
  }
  rendering.pixels[4].hit = {};
  return rendering;
}

Scene some_scene() {
  SceneData data;
  data.name = "some scene";
  data.quadrics = {{QuadricKind::sphere, {}, 1, {}, 0}};
  return Scene(std::move(data));
}

TEST(PictureModule, WritesLayersAndMetadataAsDocumented) {
  const Rendering rendering = some_rendering();
  const Scene scene = some_scene();
  const std::string name = picture_name("layers.exr");
  write_exr(name, rendering_layers(rendering, rendering_metadata(scene, "grid:amount=1", rendering)));

  const auto input = OIIO::ImageInput::open(name);
  ASSERT_TRUE(input) << OIIO::geterror();
  std::map<std::string, std::vector<std::string>> channels;
  std::map<std::string, std::vector<float>> values;
  for (int part = 0; input->seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec& spec = input->spec();
    const std::string layer(spec.get_string_attribute("oiio:subimagename"));
    channels[layer] = spec.channelnames;
    EXPECT_EQ(spec.width, 5);
    EXPECT_EQ(spec.height, 3);
    EXPECT_EQ(spec.get_string_attribute("raymeter.scene"), "some scene");
    EXPECT_EQ(spec.get_string_attribute("raymeter.spec"), "grid:amount=1");
    EXPECT_EQ(spec.get_string_attribute("raymeter.ray_hash"), "0123456789abcdef");
    EXPECT_EQ(spec.get_string_attribute("raymeter.rays"), "42");
    EXPECT_EQ(spec.get_string_attribute("raymeter.version"), RAYMETER_VERSION);
    EXPECT_EQ(spec.get_string_attribute("raymeter.scene_hash").size(), 16u);
    EXPECT_EQ(spec.get_string_attribute("raymeter.build_id").size(), 16u);
    if (layer == "primitive") {
      EXPECT_EQ(spec.format, OIIO::TypeDesc::UINT32);
      std::vector<std::uint32_t> ids(15);
      ASSERT_TRUE(input->read_image(part, 0, 0, 1, OIIO::TypeDesc::UINT32, ids.data()));
      EXPECT_EQ(ids[0], 0x01000001u);  // more than a float can hold
      EXPECT_EQ(ids[14], 0x0100000fu);
      EXPECT_EQ(ids[4], 0xffffffffu);
      continue;
    }
    EXPECT_EQ(spec.format, OIIO::TypeDesc::FLOAT);
    values[layer].resize(15 * spec.channelnames.size());
    ASSERT_TRUE(input->read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values[layer].data()));
  }
  using testing::ElementsAre;
  using testing::Pair;
  EXPECT_THAT(
      channels,
      ElementsAre(Pair("colour", ElementsAre("R", "G", "B")), Pair("depth", ElementsAre("Z")),
                  Pair("distinct_tests", ElementsAre("distinct_tests.count")),
                  Pair("empty_steps", ElementsAre("empty_steps.count")),
                  Pair("normal", ElementsAre("normal.X", "normal.Y", "normal.Z")),
                  Pair("primitive", ElementsAre("primitive.id")), Pair("steps", ElementsAre("steps.count")),
                  Pair("tests", ElementsAre("tests.count"))));
  EXPECT_EQ(values["colour"][3 * 7 + 2], 14.0f);
  EXPECT_EQ(values["depth"][7], 17.0f);
  EXPECT_EQ(values["depth"][4], std::numeric_limits<float>::infinity());
  EXPECT_EQ(values["normal"][3 * 7 + 1], -7.0f);
  EXPECT_EQ(values["steps"][7], 7.0f);
  EXPECT_EQ(values["empty_steps"][7], 107.0f);
  EXPECT_EQ(values["tests"][7], 207.0f);
  EXPECT_EQ(values["distinct_tests"][7], 307.0f);
}

TEST(PictureModule, WithoutCountsThereAreNoLayersOfThem) {
  Rendering rendering = some_rendering();
  rendering.work.clear();
  EXPECT_EQ(rendering_layers(rendering, {}).layers.size(), 4u);
}

TEST(PictureModule, WritesSrgbPixelsWithMetadata) {
  const std::string name = picture_name("pixels.png");
  Canvas canvas(7, 2, {1, 2, 3});
  canvas.set(6, 1, {250, 128, 0});
  write_png(name, canvas, {{"raymeter.spec", "octree"}});
  const auto input = OIIO::ImageInput::open(name);
  ASSERT_TRUE(input) << OIIO::geterror();
  EXPECT_EQ(input->spec().width, 7);
  EXPECT_EQ(input->spec().nchannels, 3);
  EXPECT_EQ(input->spec().get_string_attribute("raymeter.spec"), "octree");
  std::vector<std::uint8_t> bytes(42);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
  EXPECT_EQ(bytes, canvas.bytes());
}

TEST(PictureModule, SaysWhatCanNotBeWritten) {
  try {
    write_png("/nowhere/a.png", Canvas(1, 1, {}), {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("/nowhere/a.png: can't be written: "));
  }
}

}  // namespace
}  // namespace raymeter
