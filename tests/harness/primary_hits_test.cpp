// Primary hits of scenes whose counts are published, against those counts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

#include "harness/camera_rays.h"
#include "harness/ray_batch.h"
#include "scenes/geometry/decide.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

/// The part of a picture, in units of the image plane at distance 1, in which a box is seen.
struct Rectangle {
  double left = INFINITY, right = -INFINITY, bottom = INFINITY, top = -INFINITY;
};

/// Where a box is seen; a box that reaches behind the camera, everywhere.
Rectangle seen(const Bounds& box, const Vec3d& from, const Vec3d& forward, const Vec3d& right,
               const Vec3d& up) {
  Rectangle r;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vec3d p = Vec3d{corner & 1u ? box.high.x : box.low.x, corner & 2u ? box.high.y : box.low.y,
                          corner & 4u ? box.high.z : box.low.z} -
                    from;
    const double depth = dot(p, forward);
    if (depth <= 1e-3 * length(p)) return {-INFINITY, INFINITY, -INFINITY, INFINITY};
    const double x = dot(p, right) / depth, y = dot(p, up) / depth;
    r.left = std::min(r.left, x);
    r.right = std::max(r.right, x);
    r.bottom = std::min(r.bottom, y);
    r.top = std::max(r.top, y);
  }
  return r;
}

/// How many rays through pixel corners hit anything. Primitive by primitive, over the rays that it can meet.
std::int64_t count_primary_hits(const Scene& scene, std::uint32_t width) {
  const RayBatch batch = make_primary(scene, {.size = {width, width, true}, .order = RayOrder::scanline});
  const Camera& camera = scene.camera();
  const Vec3d from = to_double(camera.from), forward = normalized(to_double(camera.at) - from);
  const Vec3d right = normalized(cross(forward, to_double(camera.up))), up = cross(right, forward);
  const double reach = tan_of_half(camera.angle), half = 0.5 * width;
  const auto column = [&](double x, double margin) {
    return static_cast<std::uint32_t>(std::clamp((x / reach + 1) * half + margin, 0.0, 2 * half));
  };
  std::vector<std::uint8_t> hit(batch.rays.size());
  for (std::uint32_t i = 0; i < scene.primitive_count(); ++i) {
    const Rectangle r = seen(scene.bounds_of(i), from, forward, right, up);
    for (std::uint32_t row = column(-r.top, -1); row <= column(-r.bottom, 2); ++row)
      for (std::uint32_t x = column(r.left, -1); x <= column(r.right, 2); ++x) {
        const std::size_t ray = std::size_t{row} * (width + 1) + x;
        if (hit[ray]) continue;
        hit[ray] =
            (scene.visit(i, [&](const auto& shape) { return decide(batch.rays[ray], shape); })) != no_hit;
      }
  }
  return std::ranges::count(hit, 1);
}

struct Expected {
  const char* file;
  std::uint32_t width;
  std::int64_t hits;
  friend std::ostream& operator<<(std::ostream& out, const Expected& expected) {
    return out << expected.file;
  }
};

class PrimaryHits : public testing::TestWithParam<Expected> {};

TEST_P(PrimaryHits, EqualThePublishedCount) {
  const std::string path = std::string(RAYMETER_SHARED_DATA) + "/scenes/" + GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data";
  EXPECT_NEAR(double(count_primary_hits(open_scene(path), GetParam().width)), double(GetParam().hits), 3);
}

INSTANTIATE_TEST_SUITE_P(
    Spd, PrimaryHits,
    testing::Values(
        Expected{"spd/small/balls3.nff", 512, 263169}, Expected{"spd/small/gears2.nff", 512, 243148},
        Expected{"spd/small/jacks3.nff", 256, 18112}, Expected{"spd/small/lattice6.nff", 512, 250612},
        Expected{"spd/small/mount4.nff", 512, 173250}, Expected{"spd/small/nurbtst.nff", 256, 27739},
        Expected{"spd/small/rings3.nff", 512, 263169}, Expected{"spd/small/sample.nff", 512, 229225},
        Expected{"spd/small/sombrero1.nff", 512, 112209}, Expected{"spd/small/teapot4.nff", 512, 161203},
        Expected{"spd/small/tetra5.nff", 512, 53807}, Expected{"spd/small/tree8.nff", 512, 166903},
        Expected{"spd/standard/balls4.nff", 512, 263169}, Expected{"spd/standard/gears4.nff", 512, 245332},
        Expected{"spd/standard/jacks4.nff", 256, 24589}, Expected{"spd/standard/lattice12.nff", 512, 261170},
        Expected{"spd/standard/mount6.nff", 512, 173686}, Expected{"spd/standard/rings7.nff", 512, 263169},
        Expected{"spd/standard/sombrero2.nff", 512, 112239},
        Expected{"spd/standard/teapot12.nff", 512, 161546}, Expected{"spd/standard/tetra6.nff", 512, 49950},
        Expected{"spd/standard/tree11.nff", 512, 169909}, Expected{"spd/paper/balls2.nff", 512, 263169},
        Expected{"spd/paper/jacks2.nff", 256, 10490}, Expected{"spd/paper/lattice2.nff", 512, 144389},
        Expected{"spd/paper/rings1.nff", 512, 263169}, Expected{"spd/paper/tree4.nff", 512, 160573},
        Expected{"quadrics/il2_ballstick.nff", 512, 33388},
        Expected{"quadrics/teapot12_stadium500.nff", 512, 263169},
        Expected{"quadrics/waterbox_ballstick.nff", 512, 39339}),
    [](const auto& test) { return std::filesystem::path(test.param.file).stem().string(); });

/// A generated scene of the Standard Procedural Databases against the count of SPD's own file: it is as exact
/// as the file's, whose numbers have six digits.
struct ExpectedOfSize {
  const char* family;
  int size;
  std::uint32_t width;
  std::int64_t hits;
  friend std::ostream& operator<<(std::ostream& out, const ExpectedOfSize& expected) {
    return out << expected.family << expected.size;
  }
};

class GeneratedPrimaryHits : public testing::TestWithParam<ExpectedOfSize> {};

TEST_P(GeneratedPrimaryHits, EqualThePublishedCount) {
  const auto& [family, size, width, hits] = GetParam();
  const std::string name = fmt::format("spd/{}:size={}", family, size);
  EXPECT_NEAR(double(count_primary_hits(open_scene(name), width)), double(hits), 5);
}

const auto size_name = [](const testing::TestParamInfo<ExpectedOfSize>& test) {
  return fmt::format("{}{}", test.param.family, test.param.size);
};

INSTANTIATE_TEST_SUITE_P(
    Spd, GeneratedPrimaryHits,
    testing::Values(ExpectedOfSize{"balls", 2, 512, 263169}, ExpectedOfSize{"balls", 3, 512, 263169},
                    ExpectedOfSize{"gears", 2, 512, 243148}, ExpectedOfSize{"jacks", 2, 256, 10490},
                    ExpectedOfSize{"jacks", 3, 256, 18112}, ExpectedOfSize{"lattice", 2, 512, 144389},
                    ExpectedOfSize{"lattice", 6, 512, 250612}, ExpectedOfSize{"mount", 4, 512, 173250},
                    ExpectedOfSize{"rings", 1, 512, 263169}, ExpectedOfSize{"rings", 3, 512, 263169},
                    ExpectedOfSize{"sombrero", 1, 512, 112209}, ExpectedOfSize{"teapot", 4, 512, 161203},
                    ExpectedOfSize{"tetra", 5, 512, 53807}, ExpectedOfSize{"tree", 4, 512, 160573},
                    ExpectedOfSize{"tree", 8, 512, 166903}),
    size_name);

INSTANTIATE_TEST_SUITE_P(
    SpdSlow, GeneratedPrimaryHits,
    testing::Values(ExpectedOfSize{"balls", 4, 512, 263169}, ExpectedOfSize{"balls", 5, 512, 263169},
                    ExpectedOfSize{"gears", 4, 512, 245332}, ExpectedOfSize{"gears", 9, 512, 247173},
                    ExpectedOfSize{"jacks", 4, 256, 24589}, ExpectedOfSize{"jacks", 5, 256, 28873},
                    ExpectedOfSize{"lattice", 12, 512, 261170}, ExpectedOfSize{"lattice", 29, 512, 262875},
                    ExpectedOfSize{"mount", 6, 512, 173686}, ExpectedOfSize{"mount", 7, 512, 173635},
                    ExpectedOfSize{"mount", 8, 512, 145240}, ExpectedOfSize{"rings", 7, 512, 263169},
                    ExpectedOfSize{"rings", 17, 512, 263169}, ExpectedOfSize{"sombrero", 2, 512, 112239},
                    ExpectedOfSize{"sombrero", 4, 512, 112240}, ExpectedOfSize{"teapot", 12, 512, 161546},
                    ExpectedOfSize{"teapot", 15, 512, 161548}, ExpectedOfSize{"teapot", 30, 512, 161579},
                    ExpectedOfSize{"teapot", 40, 512, 161582}, ExpectedOfSize{"tetra", 6, 512, 49950},
                    ExpectedOfSize{"tetra", 7, 512, 46596}, ExpectedOfSize{"tetra", 8, 512, 43709},
                    ExpectedOfSize{"tree", 11, 512, 169909}, ExpectedOfSize{"tree", 15, 512, 172305}),
    size_name);

}  // namespace
}  // namespace raymeter
