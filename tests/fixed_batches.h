#pragma once
#include <algorithm>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/ray_batch.h"
#include "harness/ray_kinds.h"
#include "harness/tracing.h"

namespace raymeter {

/// The same rays at a scene on every machine: primary ones of a picture of 80x60, and the shadow and diffuse
/// ones where these hit.
inline std::vector<RayBatch> fixed_batches(const Scene& scene) {
  Registry registry;
  register_accel(registry);
  const BatchSettings settings{.size = {80, 60}};
  std::vector<RayBatch> batches{make_primary(scene, settings)};
  BatchAnswers primary;
  trace(*registry.build({"grid", {}}, {scene}), batches[0].view(), primary);
  for (const char* kind : {"shadow", "diffuse"})
    batches.push_back(make_batch(scene, ray_arguments({kind, {}}), settings, batches[0], primary.hits));
  return batches;
}

}  // namespace raymeter
