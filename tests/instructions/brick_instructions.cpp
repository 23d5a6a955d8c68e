// Builds brick-grid on small scenes and traces fixed rays with it, for callgrind to count the instructions
// of: each build and batch is one of its dumps, and a line "scene,build,primitives" or "scene,batch,rays"
// here (tests/script/instructions.sh).
#include <fmt/format.h>
#include <valgrind/callgrind.h>

#include "accel/registry.h"
#include "scenes/base/spec.h"
#include "scenes/open_scene.h"
#include "tests/fixed_batches.h"

int main() {
  using namespace raymeter;
  Registry registry;
  register_accel(registry);
  for (const char* name : {"soup:triangles=5000", "terrain:triangles=5000", "paper/3"}) {
    const Scene scene = open_scene(name);
    const auto batches = fixed_batches(scene);
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    const auto structure = registry.build(parse_spec("brick-grid:isa=avx2"), {scene});
    CALLGRIND_DUMP_STATS;
    fmt::print("{},build,{}\n", name, scene.primitive_count());
    for (const RayBatch& batch : batches) {
      BatchAnswers answers;
      make_room(answers, batch.view());
      CALLGRIND_ZERO_STATS;
      trace(*structure, batch.view(), answers);
      CALLGRIND_DUMP_STATS;
      fmt::print("{},{},{}\n", name, batch.name, batch.rays.size());
    }
    CALLGRIND_STOP_INSTRUMENTATION;
  }
}
