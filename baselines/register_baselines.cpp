#include "baselines/register_baselines.h"

#include "baselines/brute_force.h"
#include "baselines/counted_bvh.h"
#include "baselines/embree.h"

namespace raymeter {

void register_baselines(Registry& registry) {
  registry.add(embree_kind());
  registry.add(counted_bvh_kind());
  registry.add(brute_force_kind());
}

}  // namespace raymeter
