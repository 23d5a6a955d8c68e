#include "harness/camera_rays.h"

#include "harness/ray_origin.h"
#include "scenes/base/portable_math.h"
namespace raymeter {

double tan_of_half(float degrees) {
  const double half = 0.5 * degrees;
  if (half > 45) return 1 / tan_of_half(static_cast<float>(180 - double(degrees)));
  const auto [sine, cosine] = sine_cosine(half * (pi / 180));
  return sine / cosine;
}

CameraRays::CameraRays(const Camera& camera, const PictureSize& size) : size_(size), from_(camera.from) {
  const Vec3d forward = normalized(to_double(camera.at) - to_double(camera.from));
  const Vec3d right = normalized(cross(forward, to_double(camera.up)));
  const Vec3d down = cross(forward, right);
  // The picture stands at distance 1, so it reaches tan(angle / 2) to each side.
  const double pixel = 2 * tan_of_half(camera.angle) / size.width;
  right_ = pixel * right;
  down_ = pixel * down;
  corner_ = forward - (0.5 * size.width) * right_ - (0.5 * size.height) * down_;
}

Ray CameraRays::through_pixel(std::uint32_t pixel) const {
  const double middle = size_.pixel_corners ? 0 : 0.5;
  const std::uint32_t column = pixel % size_.columns(), row = pixel / size_.columns();
  Ray ray = through(column + middle, row + middle);
  ray.origin = flushed(ray.origin);
  ray.direction = flushed(ray.direction);
  return ray;
}

Ray CameraRays::through(double x, double y) const {
  return {from_, 0, to_float(normalized(corner_ + x * right_ + y * down_))};
}

}  // namespace raymeter
