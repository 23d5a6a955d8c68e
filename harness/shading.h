#pragma once
#include <optional>

#include "scenes/geometry/ray.h"
#include "scenes/scene.h"

namespace raymeter {

/// What the light that leaves a hit toward the viewer depends on. Both sides of every surface are alike: its
/// normals are those of the side that the ray came from.
struct ShadedSurface {
  const Material* material = nullptr;
  Vec3 origin;          ///< just off the surface, on the viewer's side (leave_surface)
  Vec3d view;           ///< unit vector along the ray, toward the surface
  Vec3d flat_normal;    ///< geometric
  Vec3d normal;         ///< interpolated between the corners' where the scene has them, else flat_normal
  bool inside = false;  ///< the ray came from the side away from which the geometric normal points
};

/// Nothing where leave_surface gives nothing: such a hit is black and has no secondary rays.
std::optional<ShadedSurface> shaded_surface(const Scene& scene, const Ray& ray, const Hit& hit);

/// The light of colour 1 that comes from `to_light` (not normalized, in front of the surface's normal) and
/// leaves toward the viewer, by Phong's model (1975): Kd colour cos + Ks cos_r^shine, cos_r being between
/// the mirrored light and the viewer.
Vec3d reflected_light(const ShadedSurface& surface, const Vec3d& to_light);

/// The unit direction of the mirrored ray. Where the interpolated normal would mirror it into the surface,
/// the geometric normal does.
Vec3d mirror_direction(const ShadedSurface& surface);

/// The unit direction of the refracted ray, by Snell's law: the material's index of refraction is that of the
/// side away from which the geometric normal points, 1 that of the other; an index that is not positive bends
/// nothing. Nothing where reflection is total.
std::optional<Vec3d> refracted_direction(const ShadedSurface& surface);

}  // namespace raymeter
