// A plug-in whose kernel is wrong: it loses a rim of every triangle.
#include <cmath>

#include "accel/per_ray_structure.h"
#include "accel/plugin.h"

namespace {

using raymeter::Hit;
using raymeter::Ray;

class Leaky final : public raymeter::PerRayStructure<Leaky> {
 public:
  explicit Leaky(const raymeter::Scene& scene) : PerRayStructure(scene) {}

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit best;
    for (std::uint32_t primitive = 0; primitive < scene().triangle_count(); ++primitive) {
      probe.test(primitive);
      const float t = intersect(ray, scene().triangle(primitive));
      if (t < best.t) best = {t, primitive};
    }
    return best;
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return closest_hit(ray, probe).found();
  }
  raymeter::StructureStats stats() const override { return {}; }

 private:
  static float intersect(const Ray& ray, const raymeter::Triangle& triangle) {
    constexpr float rim = 0.05f;
    const raymeter::Vec3 e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a;
    const raymeter::Vec3 p = cross(ray.direction, e2), s = ray.origin - triangle.a, q = cross(s, e1);
    const float inverse = 1 / dot(e1, p);
    const float u = dot(s, p) * inverse, v = dot(ray.direction, q) * inverse, t = dot(e2, q) * inverse;
    return u >= rim && v >= rim && u + v <= 1 - rim && t > ray.tnear && t <= ray.tfar ? t : raymeter::no_hit;
  }
};

void register_structures(raymeter::Registry& registry) {
  registry.add({.name = "wrong",
                .summary = "triangles without their rims",
                .source = "the tests",
                .answers = raymeter::Answers::within_bound,
                .build = [](const raymeter::Arguments&, const raymeter::BuildInput& input) {
                  return std::make_unique<Leaky>(input.scene);
                }});
}

}  // namespace

RAYMETER_PLUGIN(register_structures);
