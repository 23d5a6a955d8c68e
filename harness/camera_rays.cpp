#include "harness/camera_rays.h"

namespace raymeter {
namespace {

/// x^first / first! - x^(first + 2) / (first + 2)! + ... for |x| <= pi / 4, by Horner's rule: what is left
/// out is below 1e-19.
double alternating_series(double x, int first) {
  constexpr int last = 20;
  double sum = 1;
  for (int n = last + first; n > first; n -= 2) sum = 1 - x * x / (n * (n - 1.0)) * sum;
  return first == 1 ? x * sum : sum;
}

}  // namespace

double tan_of_half(float degrees) {
  constexpr double radians_per_degree = 3.14159265358979323846 / 180;
  const double half = 0.5 * degrees;
  if (half > 45) return 1 / tan_of_half(static_cast<float>(180 - double(degrees)));
  const double x = half * radians_per_degree;
  return alternating_series(x, 1) / alternating_series(x, 0);
}

CameraRays::CameraRays(const Camera& camera, std::uint32_t width, std::uint32_t height) : from_(camera.from) {
  const Vec3d forward = normalized(to_double(camera.at) - to_double(camera.from));
  const Vec3d right = normalized(cross(forward, to_double(camera.up)));
  const Vec3d down = cross(forward, right);
  // The picture stands at distance 1, so it reaches tan(angle / 2) to each side.
  const double pixel = 2 * tan_of_half(camera.angle) / width;
  right_ = pixel * right;
  down_ = pixel * down;
  corner_ = forward - (0.5 * width) * right_ - (0.5 * height) * down_;
}

Ray CameraRays::through(double x, double y) const {
  return {from_, 0, to_float(normalized(corner_ + x * right_ + y * down_))};
}

}  // namespace raymeter
