// Primary hits of scenes whose counts are published, against those counts.
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
        hit[ray] = (scene.is_triangle(i) ? decide(batch.rays[ray], scene.triangle(i))
                                         : decide(batch.rays[ray], scene.quadric(i))) != no_hit;
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

}  // namespace
}  // namespace raymeter
