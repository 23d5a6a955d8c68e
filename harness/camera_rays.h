#pragma once
#include "harness/pixel_order.h"
#include "scenes/geometry/ray.h"
#include "scenes/scene.h"

namespace raymeter {

/// tan(degrees / 2) for 0 < degrees < 180, to 1e-15 relative, from + - * / alone: equal on every machine,
/// unlike std::tan. A float's angle is assumed: degrees / 2 and 90 - degrees / 2 are then exact.
double tan_of_half(float degrees);

/// The rays of a pinhole camera through a picture of square pixels.
class CameraRays {
 public:
  /// The camera must have passed check_camera.
  CameraRays(const Camera& camera, const PictureSize& size);

  /// The one of a pixel (row * columns + column), with denormals flushed.
  Ray through_pixel(std::uint32_t pixel) const;
  /// Through the point (x, y) of the picture, in pixels from its upper left corner: x in 0 .. width,
  /// y in 0 .. height. The direction is a unit vector in double, rounded to float.
  Ray through(double x, double y) const;

 private:
  PictureSize size_;
  Vec3 from_;
  Vec3d corner_, right_, down_;  ///< from the eye to the upper left corner; one pixel to the right, one down
};

}  // namespace raymeter
