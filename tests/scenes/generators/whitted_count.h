#pragma once
#include <cmath>
#include <cstdint>
#include <memory>

#include "accel/structure.h"
#include "harness/camera_rays.h"
#include "scenes/scene.h"

namespace raymeter {

struct WhittedCounts {
  std::uint64_t primary = 0, shadow = 0, reflected = 0, refracted = 0;
  std::uint64_t total() const { return primary + shadow + reflected + refracted; }
};

/// Counts the rays of a Whitted rendering by plain recursion, ray by ray, in order to check scenes and the
/// renderer: it shares neither the renderer's shading nor its way to leave a surface. Surfaces with Ks or T
/// above 0 reflect, those with T refract unless reflection is total; each light in front of the shading
/// normal costs a shadow ray; both sides of surfaces are alike.
class WhittedCounter {
 public:
  /// `epsilon` is how far from a hit the next ray starts.
  WhittedCounter(const Scene& scene, const Structure& structure, int depth, double epsilon)
      : scene_(scene), structure_(structure), depth_(depth), epsilon_(epsilon) {}

  WhittedCounts count(std::uint32_t width, std::uint32_t height) {
    counts_ = {};
    const CameraRays rays(scene_.camera(), {width, height});
    for (std::uint32_t pixel = 0; pixel < width * height; ++pixel) {
      ++counts_.primary;
      follow(rays.through_pixel(pixel), 1);
    }
    return counts_;
  }

 private:
  void follow(const Ray& ray, int level) {
    Hit hit;
    structure_.trace_closest({.rays = {&ray, 1}}, {&hit, 1});
    if (!hit.found()) return;
    const Vec3d in = normalized(to_double(ray.direction));
    const Vec3d point = to_double(ray.origin) + double(hit.t) * to_double(ray.direction);
    const Vec3d outward = scene_.geometric_normal(hit.primitive, point);
    if (outward == Vec3d{}) return;
    const bool inside = dot(outward, in) > 0;
    const Vec3d flat = inside ? -outward : outward;
    Vec3d normal = shading_normal(hit.primitive, point, outward);
    if (dot(normal, flat) < 0) normal = -normal;

    for (const Light& light : scene_.lights())
      counts_.shadow += dot(to_double(light.position) - point, normal) > 0;
    const Material& material = scene_.material_of(hit.primitive);
    if (level == depth_ || (material.specular <= 0 && material.transmittance <= 0)) return;

    Vec3d mirrored = in - (2 * dot(in, normal)) * normal;
    if (dot(mirrored, flat) <= 0) mirrored = in - (2 * dot(in, flat)) * flat;
    ++counts_.reflected;
    follow({to_float(point + epsilon_ * flat), 0, to_float(mirrored)}, level + 1);

    const double eta = inside ? material.refraction_index : 1 / material.refraction_index;
    const double cosine = -dot(in, normal), square = 1 - eta * eta * (1 - cosine * cosine);
    if (material.transmittance <= 0 || square < 0) return;
    ++counts_.refracted;
    follow({to_float(point - epsilon_ * flat), 0,
            to_float(eta * in + (eta * cosine - std::sqrt(square)) * normal)},
           level + 1);
  }

  Vec3d shading_normal(std::uint32_t primitive, const Vec3d& point, const Vec3d& otherwise) const {
    if (!scene_.is_triangle(primitive) || scene_.triangle_normals().empty()) return otherwise;
    const auto& corners = scene_.triangle_normals()[primitive];
    if (corners[0] == SceneData::no_normal) return otherwise;
    const Triangle triangle = scene_.triangle(primitive);
    const Vec3d a = to_double(triangle.a), e = to_double(triangle.b) - a, f = to_double(triangle.c) - a,
                p = point - a;
    // p = u e + v f, by least squares.
    const double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), determinant = ee * ff - ef * ef;
    const double u = (ff * dot(p, e) - ef * dot(p, f)) / determinant,
                 v = (ee * dot(p, f) - ef * dot(p, e)) / determinant;
    return normalized((1 - u - v) * to_double(scene_.normals()[corners[0]]) +
                      u * to_double(scene_.normals()[corners[1]]) +
                      v * to_double(scene_.normals()[corners[2]]));
  }

  const Scene& scene_;
  const Structure& structure_;
  int depth_;
  double epsilon_;
  WhittedCounts counts_;
};

}  // namespace raymeter
