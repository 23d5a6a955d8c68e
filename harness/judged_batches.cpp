#include "harness/judged_batches.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "harness/ray_kinds.h"
#include "harness/timed_build.h"
#include "harness/tracing.h"
#include "harness/whitted.h"
#include "scenes/base/error.h"
#include "scenes/base/hash.h"

namespace raymeter {

std::uint64_t BatchGroup::ray_hash() const {
  Hasher hasher;
  for (const JudgedBatch& batch : batches) hasher.value(batch.rays.hash);
  return hasher.digest();
}

BatchJudge::BatchJudge(const Scene& scene, const Registry& registry, const BatchSettings& settings,
                       unsigned threads, ReferenceRefuted refuted)
    : scene_(scene),
      settings_(settings),
      reference_(build_reference(registry, {scene, threads})),
      refuted_(std::move(refuted)) {}

BatchGroup BatchJudge::batches(const Arguments& kind) {
  if (kind.name() == "whitted") return record_whitted(kind);
  if (!primary_) primary_ = judged(make_primary(scene_, settings_));
  if (kind.name() == "primary") return {{*primary_}, {}};
  return {{judged(make_batch(scene_, kind, settings_, primary_->rays, primary_->truth.answers.hits))}, {}};
}

JudgedBatch BatchJudge::judged(RayBatch rays) const {
  reference_->prepare(rays.view());
  BatchAnswers answers;
  trace(*reference_, rays.view(), answers, all_cpus());
  Truth truth = establish_truth(scene_, rays, answers, {.seed = rays.hash});
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < rays.rays.size(); ++i)
    wrong += rays.query == QueryKind::closest ? truth.answers.hits[i] != answers.hits[i]
                                              : truth.answers.occluded[i] != answers.occluded[i];
  if (wrong) refuted_(rays.name, wrong);
  return {std::move(rays), std::move(truth)};
}

BatchGroup BatchJudge::record_whitted(const Arguments& kind) const {
  const WhittedSettings whitted{.size = settings_.size,
                                .camera = settings_.camera,
                                .order = settings_.order,
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
      throw Error(fmt::format("{}: {}: more than {} rays; a smaller picture or depth has fewer",
                              scene_.name(), kind.brief(), most_rays));
    names.push_back(batch.rays.name);
    RayBatch named = batch.rays;
    named.name =
        ray_arguments({"whitted", {{"depth", fmt::format("{}", whitted.depth)}, {"rays", batch.rays.name}}})
            .canonical();
    JudgedBatch with_truth = judged(std::move(named));
    answers = with_truth.truth.answers;
    if (all || batch.rays.name == wanted) group.batches.push_back(std::move(with_truth));
  };
  const auto pixels = pixel_order(settings_.size, settings_.order, settings_.seed);
  std::vector<WhittedPixel> picture(pixels.size());
  trace_whitted(scene_, whitted, pixels, answer, picture);
  if (group.batches.empty())
    throw Error(fmt::format("{}: a Whitted rendering of depth {} has no rays '{}'; it has: all, {}",
                            scene_.name(), whitted.depth, wanted, fmt::join(names, ", ")));
  return group;
}

}  // namespace raymeter
