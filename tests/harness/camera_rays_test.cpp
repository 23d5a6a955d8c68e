#include "harness/camera_rays.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raymeter {
namespace {

TEST(TanOfHalf, AgreesWithTheStandardLibrary) {
  constexpr long double pi = 3.14159265358979323846264338328L;
  for (float degrees = 0.01f; degrees < 180; degrees += 0.0373f) {
    const long double expected = std::tan(static_cast<long double>(degrees) * pi / 360);
    ASSERT_NEAR(static_cast<double>(tan_of_half(degrees) / expected), 1, 1e-15) << degrees;
  }
  EXPECT_NEAR(tan_of_half(90), 1, 2e-16);
  EXPECT_GT(tan_of_half(std::nextafter(180.0f, 0.0f)), 7e6);
}

TEST(CameraRays, PictureSpansTheAngleAndPixelsAreSquare) {
  Camera camera;
  camera.from = {1, 2, 3};
  camera.at = {1, 2, -5};
  camera.angle = 90;
  const CameraRays rays(camera, {8, 4});
  const auto slopes = [&](double x, double y) {
    const Ray ray = rays.through(x, y);
    EXPECT_EQ(ray.origin, camera.from);
    EXPECT_NEAR(length(to_double(ray.direction)), 1, 1e-7);
    return Vec3d{ray.direction.x / -ray.direction.z, ray.direction.y / -ray.direction.z, 0};
  };
  // Looking along -z with y up, x grows to the right; the picture's row 0 is on top.
  EXPECT_NEAR(slopes(0, 0).x, -1, 1e-6);
  EXPECT_NEAR(slopes(0, 0).y, 0.5, 1e-6);
  EXPECT_NEAR(slopes(8, 4).x, 1, 1e-6);
  EXPECT_NEAR(slopes(8, 4).y, -0.5, 1e-6);
  EXPECT_NEAR(slopes(5.5, 2.5).x, 0.375, 1e-6);
  EXPECT_NEAR(slopes(5.5, 2.5).y, -0.125, 1e-6);
  EXPECT_EQ(rays.through(4, 2).direction, (Vec3{0, 0, -1}));
}

}  // namespace
}  // namespace raymeter
