#include "harness/shading.h"

#include <algorithm>
#include <cmath>

#include "harness/ray_origin.h"

namespace raymeter {
namespace {

/// Between the normals of a triangle's corners, by barycentric coordinates; {0,0,0} where it has none.
Vec3d interpolated_normal(const Scene& scene, std::uint32_t primitive, const Vec3d& point) {
  if (!scene.is_triangle(primitive) || scene.triangle_normals().empty()) return {};
  const auto& corners = scene.triangle_normals()[primitive];
  for (const std::uint32_t corner : corners)
    if (corner == SceneData::no_normal) return {};
  const Triangle t = scene.triangle(primitive);
  const Vec3d a = to_double(t.a), b = to_double(t.b), c = to_double(t.c);
  const Vec3d area = cross(b - a, c - a);
  // Each twice the part's area times the triangle's: only their proportions count.
  const double at_a = dot(cross(b - point, c - point), area), at_b = dot(cross(c - point, a - point), area),
               at_c = dot(cross(a - point, b - point), area);
  return at_a * to_double(scene.normals()[corners[0]]) + at_b * to_double(scene.normals()[corners[1]]) +
         at_c * to_double(scene.normals()[corners[2]]);
}

Vec3d mirrored(const Vec3d& in, const Vec3d& normal) {
  return normalized(in - (2 * dot(in, normal)) * normal);
}

/// Nothing where reflection is total. `eta` is the index on this side over that on the other.
std::optional<Vec3d> refracted(const Vec3d& in, const Vec3d& normal, double eta) {
  const double cosine = -dot(in, normal);
  const double square = 1 - eta * eta * (1 - cosine * cosine);
  if (square < 0) return {};
  return normalized(eta * in + (eta * cosine - std::sqrt(square)) * normal);
}

}  // namespace

std::optional<ShadedSurface> shaded_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  const auto start = leave_surface(scene, ray, hit);
  if (!start) return {};
  ShadedSurface surface;
  surface.material = &scene.material_of(hit.primitive);
  surface.origin = start->origin;
  surface.view = normalized(to_double(ray.direction));
  surface.flat_normal = surface.normal = start->normal;
  const Vec3d point = to_double(ray.origin) + double(hit.t) * to_double(ray.direction);
  surface.inside = dot(scene.geometric_normal(hit.primitive, point), start->normal) < 0;
  const Vec3d smooth = interpolated_normal(scene, hit.primitive, point);
  const double size = length(smooth);
  if (size > 0 && std::isfinite(size))
    surface.normal = (dot(smooth, start->normal) < 0 ? -1 / size : 1 / size) * smooth;
  return surface;
}

Vec3d reflected_light(const ShadedSurface& surface, const Vec3d& to_light) {
  const Material& material = *surface.material;
  const Vec3d light = normalized(to_light);
  const double cosine = dot(surface.normal, light);
  Vec3d sum = (material.diffuse * cosine) * to_double(material.colour);
  if (material.specular > 0) {
    const double along_view = dot(mirrored(light, surface.normal), surface.view);
    if (along_view > 0) {
      const double highlight = material.specular * std::pow(std::min(1.0, along_view), material.shine);
      sum = sum + Vec3d{highlight, highlight, highlight};
    }
  }
  return sum;
}

Vec3d mirror_direction(const ShadedSurface& surface) {
  const Vec3d direction = mirrored(surface.view, surface.normal);
  return dot(direction, surface.flat_normal) > 0 ? direction : mirrored(surface.view, surface.flat_normal);
}

std::optional<Vec3d> refracted_direction(const ShadedSurface& surface) {
  const double index = surface.material->refraction_index;
  const double eta = !(index > 0) ? 1 : surface.inside ? index : 1 / index;
  const auto direction = refracted(surface.view, surface.normal, eta);
  if (!direction || dot(*direction, surface.flat_normal) < 0) return direction;
  return refracted(surface.view, surface.flat_normal, eta);
}

}  // namespace raymeter
