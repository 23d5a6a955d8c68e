#pragma once
#include "scenes/base/portable_math.h"
#include "scenes/geometry/vec3.h"

namespace raymeter {

/// A linear map of vectors, by default the identity: rotations, and their products with scalings.
class Rotation {
 public:
  constexpr Rotation() = default;

  /// Counterclockwise when the unit axis points to the viewer (Rodrigues' formula).
  static constexpr Rotation about(const Vec3d& axis, const SineCosine& angle) {
    const auto turned = [&](const Vec3d& v) {
      return angle.cosine * v + angle.sine * cross(axis, v) + ((1 - angle.cosine) * dot(axis, v)) * axis;
    };
    return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})};
  }
  static constexpr Rotation about_x(const SineCosine& angle) { return about({1, 0, 0}, angle); }
  static constexpr Rotation about_y(const SineCosine& angle) { return about({0, 1, 0}, angle); }
  static constexpr Rotation about_z(const SineCosine& angle) { return about({0, 0, 1}, angle); }

  constexpr Vec3d operator()(const Vec3d& v) const { return v.x * x_ + v.y * y_ + v.z * z_; }

  /// First b, then a.
  friend constexpr Rotation operator*(const Rotation& a, const Rotation& b) {
    return {a(b.x_), a(b.y_), a(b.z_)};
  }
  friend constexpr Rotation operator*(double scale, const Rotation& a) {
    return {scale * a.x_, scale * a.y_, scale * a.z_};
  }

 private:
  constexpr Rotation(const Vec3d& x, const Vec3d& y, const Vec3d& z) : x_(x), y_(y), z_(z) {}

  Vec3d x_{1, 0, 0}, y_{0, 1, 0}, z_{0, 0, 1};  ///< where the axes go
};

}  // namespace raymeter
