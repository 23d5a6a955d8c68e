#pragma once
#include <memory>

#include "baselines/brute_force.h"
#include "harness/ray_batch.h"
#include "scenes/base/random.h"
#include "scenes/scene.h"

namespace raymeter {

/// Random triangles in the unit cube.
inline Scene random_scene(std::uint32_t triangles, std::uint64_t seed = 1) {
  Random random(seed);
  SceneData data;
  data.name = "random";
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 centre{random.uniform(), random.uniform(), random.uniform()};
    for (int corner = 0; corner < 3; ++corner)
      data.vertices.push_back(centre + Vec3{random.uniform(-0.1f, 0.1f), random.uniform(-0.1f, 0.1f),
                                            random.uniform(-0.1f, 0.1f)});
    data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return Scene(std::move(data));
}

/// Rays through the unit cube.
inline RayBatch random_batch(std::size_t rays, QueryKind query, std::uint64_t seed = 2) {
  Random random(seed);
  RayBatch batch;
  batch.name = "random";
  batch.query = query;
  batch.order = RayOrder::shuffled;
  for (std::size_t i = 0; i < rays; ++i) {
    Ray ray;
    ray.origin = {random.uniform(-1, 2), random.uniform(-1, 2), -1};
    ray.direction = Vec3{random.uniform(), random.uniform(), random.uniform()} - ray.origin;
    batch.rays.push_back(ray);
  }
  return batch;
}

inline std::unique_ptr<Structure> build_brute_force(const Scene& scene) {
  const StructureKind kind = brute_force_kind();
  return kind.build(Arguments(Spec{kind.name, {}}, kind.parameters), {scene});
}

}  // namespace raymeter
