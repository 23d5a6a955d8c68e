#include "harness/rendering.h"

#include <gmock/gmock.h>

#include <bit>
#include <filesystem>

#include "accel/registry.h"
#include "baselines/register_baselines.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"
#include "test_scenes.h"

namespace raymeter {
namespace {

Registry all_structures() {
  Registry registry;
  register_accel(registry);
  register_baselines(registry);
  return registry;
}

std::string shared_scene(const std::string& file) {
  return std::string(RAYMETER_SHARED_DATA) + "/" + file;
}

/// The same in every bit.
void expect_same(const Rendering& a, const Rendering& b) {
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a.pixels[i].colour[axis]),
                std::bit_cast<std::uint64_t>(b.pixels[i].colour[axis]))
          << "pixel " << i;
    ASSERT_EQ(a.pixels[i].hit, b.pixels[i].hit) << "pixel " << i;
    ASSERT_EQ(a.pixels[i].normal, b.pixels[i].normal) << "pixel " << i;
  }
  EXPECT_EQ(a.ray_hash, b.ray_hash);
  ASSERT_EQ(a.rays.size(), b.rays.size());
  for (std::size_t i = 0; i < a.rays.size(); ++i) {
    EXPECT_EQ(a.rays[i].rays, b.rays[i].rays);
    EXPECT_EQ(a.rays[i].hits, b.rays[i].hits);
  }
}

class RenderingOf : public testing::TestWithParam<const char*> {};

/// With every exact structure the same as with brute force.
void check_structures(const Scene& scene, const RenderSettings& settings) {
  const Registry registry = all_structures();
  const Rendering truth = render(scene, *registry.build({"brute-force", {}}, {scene}), settings);
  for (const StructureKind& kind : registry.kinds()) {
    if (kind.answers != Answers::exact || kind.name == "brute-force") continue;
    SCOPED_TRACE(kind.name);
    expect_same(truth, render(scene, *registry.build({kind.name, {}}, {scene}), settings));
  }
}

TEST_P(RenderingOf, IsTheSameWithEveryExactStructure) {
  std::string scene = GetParam();
  if (scene.ends_with(".nff")) {
    scene = shared_scene("scenes/" + scene);
    if (!std::filesystem::exists(scene)) GTEST_SKIP() << "no shared data";
  }
  check_structures(open_scene(scene), {.size = {40, 30}, .depth = 5, .threads = 2});
}

TEST(RenderingOfThePapersScenes, IsTheSameWithEveryExactStructure) {
  check_structures(open_scene("paper/1"), {.size = {120, 90}, .depth = 4, .threads = 2});
  check_structures(open_scene("paper/2"), {.size = {32, 24}, .depth = 1, .threads = 2});
  check_structures(open_scene("paper/3"), {.size = {48, 36}, .depth = 2, .threads = 2});
}

INSTANTIATE_TEST_SUITE_P(SpdSmall, RenderingOf,
                         testing::Values("spd/balls:size=3", "spd/gears:size=2", "spd/jacks:size=3",
                                         "spd/lattice:size=6", "spd/mount:size=4", "spd/rings:size=3",
                                         "spd/sombrero:size=1", "spd/teapot:size=4", "spd/tetra:size=5",
                                         "spd/tree:size=8", "spd/small/nurbtst.nff", "spd/small/sample.nff"),
                         [](const auto& test) {
                           const std::string name = std::filesystem::path(test.param).filename().string();
                           return name.substr(0, name.find_first_of(":."));
                         });

Scene spheres() {
  Random random(5);
  SceneData data;
  for (int i = 0; i < 60; ++i) {
    const float x = random.uniform(-2, 2), y = random.uniform(-2, 2);
    data.quadrics.push_back({QuadricKind::sphere, {x, y, random.uniform(-2, 2)}, 0.3f, {}, 0});
    data.quadric_materials.push_back(static_cast<std::uint32_t>(i % 3));
  }
  data.materials = {Material{{1, 0, 0}, 0.6f, 0.4f, 20, 0, 1},
                    Material{{1, 1, 1}, 0.1f, 0.1f, 20, 0.8f, 1.5f}, Material{}};
  data.background = {0.1f, 0.2f, 0.3f};
  return Scene(std::move(data));
}

TEST(Rendering, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = spheres();
  const auto structure = all_structures().build({"grid", {}}, {scene});
  RenderSettings settings{.size = {150, 130}, .depth = 6, .threads = 1, .count = true};
  const Rendering one = render(scene, *structure, settings);
  for (const unsigned threads : {2u, 5u}) {
    settings.threads = threads;
    const Rendering more = render(scene, *structure, settings);
    expect_same(one, more);
    for (std::size_t i = 0; i < one.work.size(); ++i) ASSERT_EQ(one.work[i].steps, more.work[i].steps);
  }
}

TEST(Rendering, CountsTheWorkOfEachPixel) {
  const Scene scene = spheres();
  const auto brute = all_structures().build({"brute-force", {}}, {scene});
  RenderSettings settings{.size = {70, 65}, .depth = 3, .count = true, .primary_only = true};
  const Rendering primary = render(scene, *brute, settings);
  settings.primary_only = false;
  const Rendering all = render(scene, *brute, settings);
  std::uint64_t rays = 0, most_tests = 0;
  for (const RayCount& count : all.rays) rays += count.rays;
  for (std::size_t i = 0; i < all.work.size(); ++i) {
    ASSERT_EQ(primary.work[i].tests, 60u);
    ASSERT_EQ(primary.work[i].distinct_tests, 60u);
    ASSERT_GE(all.work[i].tests, 60u);
    if (!all.pixels[i].hit.found()) {
      ASSERT_EQ(all.work[i].tests, 60u);
    }
    most_tests += all.work[i].tests;
  }
  EXPECT_GT(most_tests, 60u * all.work.size());
  EXPECT_LE(most_tests, 60u * rays);  // shadow rays stop at the first hit
  settings.count = false;
  EXPECT_TRUE(render(scene, *brute, settings).work.empty());
}

TEST(Rendering, PixelsAreRowByRowAndProgressIsTold) {
  SceneData data;
  data.quadrics = {{QuadricKind::sphere, {3, 2, 0}, 0.5f, {}, 0}};  // to the upper right
  data.camera = Camera{{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 60};
  const Scene scene(std::move(data));
  std::size_t last = 0, total = 0;
  const Rendering rendering = render(scene, *build_brute_force(scene), {.size = {130, 70}, .threads = 2},
                                     [&](std::size_t done, std::size_t of) {
                                       EXPECT_EQ(done, last + 1);
                                       last = done;
                                       total = of;
                                     });
  EXPECT_EQ(last, 6u);
  EXPECT_EQ(total, 6u);
  // The picture reaches 5.77 to each side at the sphere's distance.
  const auto hit = [&](std::uint32_t x, std::uint32_t y) {
    return rendering.pixels[y * 130 + x].hit.found();
  };
  EXPECT_TRUE(hit(65 + 34, 35 - 23));
  EXPECT_FALSE(hit(65 - 34, 35 - 23));
  EXPECT_FALSE(hit(65 + 34, 35 + 23));
}

TEST(Rendering, AMirrorRoomEndsAtTheDepthLimit) {
  const std::string path = shared_scene("hostile/n25_mirror_room.nff");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
  const Scene scene = open_scene(path);
  const Rendering rendering = render(scene, *build_brute_force(scene), {.size = {8, 8}, .depth = 1000});
  EXPECT_EQ(rendering.total(RayPurpose::primary).hits, 64u);
  EXPECT_EQ(rendering.rays.back().depth, 1000u);
  EXPECT_EQ(rendering.total(RayPurpose::reflection).rays, 999u * 64u);
}

/// Balls of glass in a ball of mirror: every generation has almost twice the rays of the one before.
TEST(Rendering, ARoomOfGlassAndMirrorEndsAtTheMostRays) {
  const Material mirror{{1, 1, 1}, 0, 0.75f, 1, 0, 1}, glass{{1, 1, 1}, 0, 0, 1, 0.5f, 1.5f};
  SceneData data;
  data.materials = {mirror, glass};
  data.quadric_materials = {0, 1, 1};
  for (const auto& [x, radius] : {std::pair{0.0f, 10.0f}, {-4.0f, 3.5f}, {4.0f, 3.5f}})
    data.quadrics.push_back({QuadricKind::sphere, {x, 0, 0}, radius, {}, 0});
  data.camera = Camera{{0, 5, 5}, {4, 0, 0}, {0, 0, 1}, 60};
  const Scene scene(std::move(data));
  try {
    render(scene, *build_brute_force(scene), {.size = {8, 8}, .depth = 64, .threads = 2});
    FAIL() << "ended by itself";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("more than 1048576 rays"));
  }
  EXPECT_EQ(render(scene, *build_brute_force(scene), {.size = {8, 8}, .depth = 5}).rays.back().depth, 5u);
}

TEST(Rendering, RefusesPicturesThatAreTooLarge) {
  const Scene scene = spheres();
  const auto brute = build_brute_force(scene);
  for (const PictureSize size : {PictureSize{1000000, 1000000}, PictureSize{0xffffffffu, 1},
                                 PictureSize{0xffffffffu, 0xffffffffu, true}, PictureSize{8193, 8192}}) {
    try {
      render(scene, *brute, {.size = size});
      ADD_FAILURE() << size.width << "x" << size.height << " was not refused";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("67108864 pixels are the most"));
    }
  }
  EXPECT_THROW(render(scene, *brute, {.size = {0, 5}}), Error);
  check_picture({8192, 8192});
}

}  // namespace
}  // namespace raymeter
