// Compares small-bvh with everything that Raymeter has, on the scenes named on the command line.
#include <cstdio>

#include "baselines/register_baselines.h"
#include "harness/comparison.h"
#include "reports/comparison_recorder.h"
#include "reports/comparison_table.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"
#include "small_bvh.h"

int main(int argc, char** argv) {
  try {
    raymeter::Registry registry;
    raymeter::register_accel(registry);
    raymeter::register_baselines(registry);
    register_small_bvh(registry);

    raymeter::ComparisonSettings settings;  // every structure, four kinds of rays, against Embree
    settings.race.time_budget = 5;
    raymeter::ComparisonRecorder recorder(registry);
    for (int i = 1; i < argc; ++i) {
      raymeter::compare_structures(raymeter::open_scene(argv[i]), registry, settings, recorder);
      std::puts(raymeter::comparison_table(recorder.take_records(), registry).c_str());
    }
    return recorder.all_right() ? 0 : 1;
  } catch (const raymeter::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
