#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/ray_batch.h"
#include "scenes/geometry/decide.h"
#include "scenes/scene.h"

namespace raymeter {

inline Hit closest_hit_by_brute_force(const Scene& scene, const Ray& ray) {
  Hit best;
  for (std::uint32_t i = 0; i < scene.primitive_count(); ++i) {
    const float t = scene.visit(i, [&](const auto& shape) { return decide(ray, shape); });
    if (t != no_hit) best = std::min(best, Hit{t, i});
  }
  return best;
}

inline std::vector<Hit> closest_hits_by_brute_force(const Scene& scene, const RayBatch& batch) {
  std::vector<Hit> hits;
  for (const Ray& ray : batch.rays) hits.push_back(closest_hit_by_brute_force(scene, ray));
  return hits;
}

}  // namespace raymeter
