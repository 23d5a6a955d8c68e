#include "harness/judged_batches.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <thread>

#include "harness/ray_kinds.h"
#include "harness/whitted.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"

namespace raymeter {
namespace {

/// For what is not timed.
unsigned all_cpus() {
  return std::max(1u, std::thread::hardware_concurrency());
}

JudgedBatch judge(const Scene& scene, Structure& reference, RayBatch rays, const ReferenceRefuted& refuted) {
  reference.prepare(rays.view());
  BatchAnswers answers;
  trace(reference, rays.view(), answers, all_cpus());
  Truth truth = establish_truth(scene, rays, answers, {.seed = rays.hash});
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.rays.size(); ++i)
    wrong += rays.query == QueryKind::closest ? truth.answers.hits[i] != answers.hits[i]
                                              : truth.answers.occluded[i] != answers.occluded[i];
  if (wrong) refuted(rays.name, wrong);
  return {std::move(rays), std::move(truth)};
}

/// Records a Whitted rendering of which every generation starts from true hits.
BatchGroup record_whitted(const Scene& scene, Structure& reference, const BatchSettings& settings,
                          const Arguments& kind, const ReferenceRefuted& refuted) {
  const WhittedSettings whitted{.size = settings.size,
                                .camera = settings.camera,
                                .order = settings.order,
                                .depth = static_cast<unsigned>(kind.integer("depth"))};
  const std::string& wanted = kind.text("rays");
  const bool all = wanted == "all";
  BatchGroup group;
  if (all) group.sum_name = kind.canonical();
  std::vector<std::string> names;
  std::uint64_t rays = 0;
  const auto answer = [&](const WhittedBatch& batch, BatchAnswers& answers) {
    rays += batch.rays.rays.size();
    if (rays > most_rays)
      throw Error(fmt::format("{}: {}: more than {} rays; a smaller picture or depth has fewer", scene.name(),
                              kind.brief(), most_rays));
    names.push_back(batch.rays.name);
    RayBatch named = batch.rays;
    named.name =
        ray_arguments({"whitted", {{"depth", fmt::format("{}", whitted.depth)}, {"rays", batch.rays.name}}})
            .canonical();
    JudgedBatch judged = judge(scene, reference, std::move(named), refuted);
    answers = judged.truth.answers;
    if (all || batch.rays.name == wanted) group.batches.push_back(std::move(judged));
  };
  const auto pixels = pixel_order(settings.size, settings.order, settings.seed);
  std::vector<WhittedPixel> picture(pixels.size());
  trace_whitted(scene, whitted, pixels, answer, picture);
  if (group.batches.empty())
    throw Error(fmt::format("{}: a Whitted rendering of depth {} has no rays '{}'; it has: all, {}",
                            scene.name(), whitted.depth, wanted, fmt::join(names, ", ")));
  return group;
}

}  // namespace

std::uint64_t BatchGroup::ray_hash() const {
  Hasher hasher;
  for (const JudgedBatch& batch : batches) hasher.value(batch.rays.hash);
  return hasher.digest();
}

std::vector<BatchGroup> make_judged_batches(const Scene& scene, Structure& reference,
                                            const BatchSettings& settings, std::span<const Arguments> kinds,
                                            const ReferenceRefuted& refuted) {
  const JudgedBatch primary = judge(scene, reference, make_primary(scene, settings), refuted);
  std::vector<BatchGroup> groups;
  for (const Arguments& kind : kinds) {
    if (kind.name() == "primary")
      groups.push_back({{primary}, {}});
    else if (kind.name() == "whitted")
      groups.push_back(record_whitted(scene, reference, settings, kind, refuted));
    else
      groups.push_back(
          {{judge(scene, reference,
                  make_batch(scene, kind, settings, primary.rays, primary.truth.answers.hits), refuted)},
           {}});
  }
  return groups;
}

}  // namespace raymeter
