#include "cli/rays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

#include "harness/judged_batches.h"
#include "harness/ray_file.h"
#include "harness/ray_kinds.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {

int run_rays(const RaysOptions& options, const Registry& registry) {
  const Arguments kind = ray_arguments(parse_spec(options.kind));
  const BatchSettings settings = batch_settings(options.batches);
  const Scene scene = open_scene(options.scene);
  bool in_doubt = false;
  BatchJudge judge(scene, registry, settings, all_cpus(), [&](std::string_view batch, std::size_t rays) {
    in_doubt = true;
    fmt::print(stderr,
               "raymeter: {}: brute force refutes the reference hits on {} rays; please report this\n", batch,
               rays);
  });
  const BatchGroup group = judge.batches(kind);
  if (group.batches.size() > 1) {
    std::vector<std::string> parts;
    for (const JudgedBatch& part : group.batches)
      parts.push_back(ray_arguments(parse_spec(part.rays.name)).text("rays"));
    throw Error(fmt::format("{}: these are {} batches, and a file holds one; add rays= and one of: {}",
                            kind.brief(), parts.size(), fmt::join(parts, ", ")));
  }
  const RayBatch& batch = group.batches.front().rays;
  write_ray_file(options.out, batch, scene);
  fmt::print("{}: {} rays, {}, ray hash {:016x}\n  of {}, scene hash {:016x}\n", options.out,
             batch.rays.size(), batch.name, batch.hash, scene.name(), scene.hash());
  return in_doubt ? 1 : 0;
}

}  // namespace raymeter
