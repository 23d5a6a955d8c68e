// What a generated scene's own camera sees of it.
#include <gtest/gtest.h>

#include "accel/registry.h"
#include "harness/ray_batch.h"
#include "harness/tracing.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

/// The part of the primary rays that hit.
double seen(const std::string& name) {
  const Scene scene = open_scene(name);
  Registry registry;
  register_accel(registry);
  const auto structure = registry.build(parse_spec("two-level-grid"), {scene});
  BatchSettings settings;
  settings.size = {80, 60};
  const RayBatch primary = make_primary(scene, settings);
  BatchAnswers answers;
  trace(*structure, primary.view(), answers, 1);
  return static_cast<double>(count_hits(answers)) / static_cast<double>(primary.rays.size());
}

TEST(GeneratorViews, SlowAtLeastHalfOfThePrimaryRaysHitAtEveryTurnOfTheKnob) {
  for (const char* name :
       {"soup", "terrain", "clusters", "clusters:clustering=0", "clusters:clustering=1", "crowding",
        "crowding:kappa=1", "crowding:kappa=1e-3", "sizes", "sizes:sigma=0", "sizes:sigma=2", "slivers",
        "slivers:aspect=1", "slivers:aspect=1e4", "stadium:ratio=3", "stadium:ratio=1e5", "two-scales",
        "two-scales:ratio=1", "two-scales:ratio=1e4"})
    EXPECT_GE(seen(name), 0.5) << name;
}

}  // namespace
}  // namespace raymeter
