#include "harness/ray_origin.h"

#include <cmath>
#include <limits>

namespace raymeter {
namespace {

/// Positive outside the quadric (of a cone: of the endless one), negative inside, as geometric_normal points
/// outward.
double outside(const Quadric& q, const Vec3d& p) {
  const Vec3d w = p - to_double(q.base);
  const double r = q.base_radius;
  if (q.kind == QuadricKind::sphere) return dot(w, w) - r * r;
  // |w x A|^2 / L is the squared distance from the axis, r + delta (w . A) / L the radius at that height.
  const Vec3d axis = to_double(q.apex) - to_double(q.base), across = cross(w, axis);
  const double l = dot(axis, axis), radius = r + (double(q.apex_radius) - r) * dot(w, axis) / l;
  return dot(across, across) / l - radius * radius;
}

}  // namespace

Vec3 flushed(Vec3 v) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(v[axis]) < std::numeric_limits<float>::min()) v[axis] = 0;
  return v;
}

std::optional<SurfaceStart> leave_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  if (!hit.found()) return {};
  const Vec3d along = double(hit.t) * to_double(ray.direction);
  const Vec3d point = to_double(ray.origin) + along;
  Vec3d normal = scene.geometric_normal(hit.primitive, point);
  if (normal == Vec3d{}) return {};
  const bool from_outside = dot(normal, to_double(ray.direction)) <= 0;
  if (!from_outside) normal = -normal;

  double error = 0;
  for (int axis = 0; axis < 3; ++axis)
    error += std::abs(normal[axis]) *
             (0x1p-24 * (std::abs(along[axis]) + std::abs(point[axis])) + std::numeric_limits<float>::min());

  constexpr int most_doublings = 16;
  double shift = 4 * error;
  for (int i = 0; i <= most_doublings; ++i, shift *= 2) {
    const Vec3 origin = flushed(to_float(point + shift * normal));
    if (!is_finite(origin)) return {};
    if (scene.is_triangle(hit.primitive)) return SurfaceStart{origin, normal};
    const double side = outside(scene.quadric(hit.primitive), to_double(origin));
    if (from_outside ? side > 0 : side < 0) return SurfaceStart{origin, normal};
  }
  // A quadric no larger than the rounding of its position: it has no inside to start from.
  return {};
}

}  // namespace raymeter
