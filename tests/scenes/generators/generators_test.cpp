#include "scenes/generators/generators.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

double mean_extent(const Scene& scene) {
  double sum = 0;
  for (std::uint32_t i = 0; i < scene.primitive_count(); ++i) sum += scene.bounds_of(i).diagonal();
  return sum / static_cast<double>(scene.primitive_count());
}

/// The part of a 32^3 grid of the unit cube in which primitives have their centre.
double occupied(const Scene& scene) {
  std::vector<bool> cells(32 * 32 * 32);
  for (std::uint32_t i = 0; i < scene.primitive_count(); ++i) {
    const Bounds box = scene.bounds_of(i);
    std::size_t cell = 0;
    for (int axis = 0; axis < 3; ++axis)
      cell = cell * 32 +
             static_cast<std::size_t>(std::clamp(16 * (double(box.low[axis]) + box.high[axis]), 0.0, 31.0));
    cells[cell] = true;
  }
  return static_cast<double>(std::ranges::count(cells, true)) / static_cast<double>(cells.size());
}

TEST(Generators, ScenesAreTheSameOnEveryMachine) {
  EXPECT_EQ(open_scene("soup:triangles=1000:seed=3").hash(), 6138740544306992788u);
  EXPECT_EQ(open_scene("terrain:triangles=1000:seed=3").hash(), 2031861255189932900u);
  EXPECT_EQ(open_scene("clusters:objects=1000:seed=3").hash(), 14949918358741213165u);
  EXPECT_EQ(open_scene("clusters:objects=1000:seed=3:primitive=sphere").hash(), 4881144759001242577u);
  EXPECT_EQ(open_scene("clusters:objects=1000:seed=3:primitive=cone").hash(), 14804472965663703295u);
}

TEST(Generators, DefaultsMakeSoundScenes) {
  for (const SceneGenerator& generator : scene_generators()) {
    const Scene scene = open_scene(generator.name);
    EXPECT_THAT(scene.warnings(), testing::IsEmpty()) << generator.name;
    EXPECT_GT(scene.primitive_count(), 0u) << generator.name;
  }
}

TEST(Generators, CountsAreThoseAskedFor) {
  EXPECT_EQ(open_scene("soup:triangles=1").triangle_count(), 1u);
  EXPECT_EQ(open_scene("clusters:objects=7:primitive=sphere").primitive_count(), 7u);
  EXPECT_EQ(open_scene("clusters:objects=7:primitive=sphere").triangle_count(), 0u);
  EXPECT_EQ(open_scene("clusters:objects=7:primitive=cone:clusters=100").primitive_count(), 7u);
  // 2 n^2, n the nearest.
  EXPECT_EQ(open_scene("terrain:triangles=2").triangle_count(), 2u);
  EXPECT_EQ(open_scene("terrain:triangles=200").triangle_count(), 200u);
  EXPECT_EQ(open_scene("terrain:triangles=210").triangle_count(), 200u);
  EXPECT_EQ(open_scene("terrain:triangles=60000").triangle_count(), 2u * 173 * 173);
}

TEST(Generators, LimitsAreKept) {
  for (const char* name :
       {"soup:triangles=0", "soup:triangles=2e8", "soup:size=0", "terrain:triangles=1",
        "terrain:roughness=1.5", "clusters:clustering=-0.1", "clusters:clustering=1.1",
        "clusters:primitive=torus", "clusters:clusters=0", "clusters:objects=1e9", "lattice"})
    EXPECT_THROW(open_scene(name), Error) << name;
}

TEST(Terrain, IsOneClosedHeightFieldAndRoughnessRoughens) {
  const Scene scene = open_scene("terrain:triangles=5000");
  double area = 0;
  for (std::uint32_t i = 0; i < scene.triangle_count(); ++i) {
    const Triangle t = scene.triangle(i);
    // All triangles face up, and over the square they leave no gap.
    const double z = cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a)).z;
    ASSERT_GT(z, 0);
    area += z / 2;
  }
  EXPECT_NEAR(area, 1, 1e-5);
  EXPECT_EQ(scene.bounds().low, (Vec3{0, 0, 0}));
  EXPECT_EQ(scene.bounds().high, (Vec3{1, 1, 0.3f}));
  EXPECT_GT(mean_extent(open_scene("terrain:triangles=5000:roughness=0.9")), 1.2 * mean_extent(scene));
  EXPECT_GT(mean_extent(scene), 1.02 * mean_extent(open_scene("terrain:triangles=5000:roughness=0")));
}

TEST(Clusters, TheKnobCrowdsAndShrinks) {
  for (const char* primitive : {"triangle", "sphere", "cone"}) {
    double last_extent = INFINITY, last_occupied = 1;
    for (const char* clustering : {"0", "0.5", "0.8", "0.95", "1"}) {
      const Scene scene = open_scene(std::string("clusters:objects=20000:size=0.01:clustering=") +
                                     clustering + ":primitive=" + primitive);
      EXPECT_LT(mean_extent(scene), 0.6 * last_extent) << primitive << clustering;
      EXPECT_LT(occupied(scene), 0.95 * last_occupied) << primitive << clustering;
      last_extent = mean_extent(scene);
      last_occupied = occupied(scene);
    }
    // Evenly spread, 20000 objects leave e^(-20000/32768) = 54% of the cells empty.
    EXPECT_NEAR(occupied(open_scene("clusters:objects=20000:size=0.001:clustering=0")), 0.457, 0.02);
    EXPECT_LE(last_occupied, 16 * 8 / 32768.0);
  }
}

}  // namespace
}  // namespace raymeter
