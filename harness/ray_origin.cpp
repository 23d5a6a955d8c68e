#include "harness/ray_origin.h"

#include <cmath>
#include <limits>

namespace raymeter {

Vec3 flushed(Vec3 v) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(v[axis]) < std::numeric_limits<float>::min()) v[axis] = 0;
  return v;
}

namespace {

/// `side` is 1 for the side that the ray came from, -1 for the other one.
std::optional<SurfaceStart> start_beside_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                                 double side) {
  if (!hit.found()) return {};
  const Vec3d along = double(hit.t) * to_double(ray.direction);
  const Vec3d point = to_double(ray.origin) + along;
  Vec3d normal = scene.geometric_normal(hit.primitive, point);
  if (normal == Vec3d{}) return {};
  if (dot(normal, to_double(ray.direction)) > 0) normal = -normal;

  double error = 0;
  for (int axis = 0; axis < 3; ++axis)
    error += std::abs(normal[axis]) *
             (0x1p-24 * (std::abs(along[axis]) + std::abs(point[axis])) + std::numeric_limits<float>::min());

  const Vec3 origin = flushed(to_float(point + (side * 4 * error) * normal));
  if (!is_finite(origin)) return {};
  return SurfaceStart{origin, normal};
}

}  // namespace

std::optional<SurfaceStart> leave_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  return start_beside_surface(scene, ray, hit, 1);
}

std::optional<SurfaceStart> enter_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  return start_beside_surface(scene, ray, hit, -1);
}

}  // namespace raymeter
