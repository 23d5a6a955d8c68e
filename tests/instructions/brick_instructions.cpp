// Builds brick-grid on small scenes and traces fixed rays with it, one by one and the coherent ones in
// packets, too, for callgrind to count the instructions of: each build and batch is one of its dumps, and a
// line "scene,build,primitives" or "scene,batch,rays" here (tests/script/instructions.sh).
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
    const auto singly = registry.build(parse_spec("brick-grid:isa=avx2:query=1"), {scene});
    CALLGRIND_DUMP_STATS;
    fmt::print("{},build,{}\n", name, scene.primitive_count());
    const auto in_packets = registry.build(parse_spec("brick-grid:isa=avx2:query=16"), {scene});
    const auto trace_batch = [&](const Structure& structure, const RayBatch& batch, const char* how) {
      BatchAnswers answers;
      make_room(answers, batch.view());
      CALLGRIND_ZERO_STATS;
      trace(structure, batch.view(), answers);
      CALLGRIND_DUMP_STATS;
      fmt::print("{},{}{},{}\n", name, batch.name, how, batch.rays.size());
    };
    for (const RayBatch& batch : batches) {
      trace_batch(*singly, batch, "");
      if (batch.coherent) trace_batch(*in_packets, batch, " in packets");
    }
    CALLGRIND_STOP_INSTRUMENTATION;
  }
}
