#pragma once
// The one place where a traversal meets a primitive: filter, then `decide`.
#include <algorithm>

#include "accel/probe.h"
#include "scenes/geometry/decide.h"
#include "scenes/geometry/filter.h"
#include "scenes/scene.h"

namespace raymeter {

/// Tests one primitive against `ray` and keeps the better of its hit and `best`. `best` starts as Hit{}.
template <class Probe>
inline void test_closest(const Scene& scene, std::uint32_t primitive, const FilterRay& ray, Hit& best,
                         Probe& probe) {
  probe.test(primitive);
  const float tmax = std::min(best.t, ray.ray.tfar);
  const float t = scene.visit(primitive, [&](const auto& shape) {
    if (!may_hit(ray, shape, tmax)) return no_hit;
    probe.decide();
    return decide(ray.ray, shape);
  });
  if (t == no_hit) return;
  const Hit hit{t, primitive};
  if (hit < best) best = hit;
}

/// Whether the primitive is hit in the ray's interval.
template <class Probe>
inline bool test_any(const Scene& scene, std::uint32_t primitive, const FilterRay& ray, Probe& probe) {
  probe.test(primitive);
  return scene.visit(primitive, [&](const auto& shape) {
    if (!may_hit(ray, shape, ray.ray.tfar)) return false;
    probe.decide();
    return decide(ray.ray, shape) != no_hit;
  });
}

/// Every primitive tested: for rays that a structure can't walk (walk_space.h).
template <class Probe>
Hit closest_of_all(const Scene& scene, const Ray& ray, Probe& probe) {
  const FilterRay filter(ray);
  Hit best;
  for (std::uint32_t p = 0; p < scene.primitive_count(); ++p) test_closest(scene, p, filter, best, probe);
  return best;
}
template <class Probe>
bool any_of_all(const Scene& scene, const Ray& ray, Probe& probe) {
  const FilterRay filter(ray);
  for (std::uint32_t p = 0; p < scene.primitive_count(); ++p)
    if (test_any(scene, p, filter, probe)) return true;
  return false;
}

}  // namespace raymeter
