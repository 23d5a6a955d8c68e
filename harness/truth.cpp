#include "harness/truth.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "accel/primitive_test.h"
#include "baselines/brute_force.h"
#include "harness/dispute.h"
#include "scenes/base/random.h"

namespace raymeter {
namespace {

float decide_primitive(const Scene& scene, std::uint32_t primitive, const FilterRay& ray) {
  Hit hit;
  NoProbe probe;
  test_closest(scene, primitive, ray, hit, probe);
  return hit.t;
}

/// Ray-primitive tests that brute force takes for a ray.
double cost_of_ray(const Scene& scene) {
  return std::max<double>(1, static_cast<double>(scene.primitive_count()));
}

bool equal_at(const BatchAnswers& a, const BatchAnswers& b, QueryKind query, std::size_t ray) {
  return query == QueryKind::closest ? a.hits[ray] == b.hits[ray] : a.occluded[ray] == b.occluded[ray];
}

/// Whether a row contradicts what is taken for true, by more than is to be expected of it.
bool contradicts(const Scene& scene, const RayBatch& batch, const BatchAnswers& truth, const Row& row,
                 std::size_t ray) {
  if (equal_at(truth, row.answers, batch.query, ray)) return false;
  if (row.policy == Answers::exact) return true;
  if (batch.query == QueryKind::any) return row.answers.occluded[ray] != occlusion_not_answered;
  const Hit& answer = row.answers.hits[ray];
  if (!answer.found() && !truth.hits[ray].found()) return false;  // a miss, whatever its t
  return answer.primitive != not_answered && !explain_hit(scene, batch.rays[ray], truth.hits[ray], answer);
}

/// `count` different indices below `size`, in ascending order (Floyd's method would do without the array; the
/// batch is larger than it anyway).
std::vector<std::size_t> sample_indices(std::size_t size, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> indices(size);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  if (count >= size) return indices;
  Random random(seed);
  for (std::size_t i = 0; i < count; ++i)
    std::swap(indices[i], indices[i + random.below(static_cast<std::uint32_t>(size - i))]);
  indices.resize(count);
  std::sort(indices.begin(), indices.end());
  return indices;
}

/// Replaces what is believed about the given rays by what brute force says.
void prove(const Scene& scene, const RayBatch& batch, std::span<const std::size_t> indices, Truth& truth) {
  std::vector<Ray> rays;
  std::vector<std::size_t> open;
  for (const std::size_t i : indices)
    if (!truth.proved[i]) {
      open.push_back(i);
      rays.push_back(batch.rays[i]);
    }
  const BatchAnswers proved = brute_force(scene, rays, batch.query);
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (batch.query == QueryKind::closest)
      truth.answers.hits[open[i]] = proved.hits[i];
    else
      truth.answers.occluded[open[i]] = proved.occluded[i];
    truth.proved[open[i]] = 1;
  }
  truth.brute_forced += open.size();
}

}  // namespace

BatchAnswers brute_force(const Scene& scene, std::span<const Ray> rays, QueryKind query) {
  BatchAnswers answers;
  if (query == QueryKind::closest)
    answers.hits.resize(rays.size());
  else
    answers.occluded.resize(rays.size());
  const auto structure = brute_force_kind().build(Arguments({"brute-force", {}}, {}), {scene});
  // Finer than the chunks of tracing.h: a ray takes so long that a hundred are worth sharing.
  const std::size_t cpus = all_cpus();
  const std::size_t group = std::clamp<std::size_t>(rays.size() / (4 * cpus), 1, 128);
  tbb::parallel_for(std::size_t{0}, (rays.size() + group - 1) / group, [&](std::size_t index) {
    const std::size_t first = index * group, count = std::min(group, rays.size() - first);
    const BatchView view{rays.subspan(first, count), query};
    if (query == QueryKind::closest)
      structure->trace_closest(view, std::span(answers.hits).subspan(first, count));
    else
      structure->trace_any(view, std::span(answers.occluded).subspan(first, count));
  });
  return answers;
}

std::vector<Hit> all_hits(const Scene& scene, const Ray& ray) {
  std::vector<Hit> hits;
  if (!is_traceable(ray)) return hits;
  const FilterRay filter(ray);
  for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive) {
    const float t = decide_primitive(scene, primitive, filter);
    if (t != no_hit) hits.push_back({t, primitive});
  }
  std::sort(hits.begin(), hits.end());
  return hits;
}

Truth establish_truth(const Scene& scene, const RayBatch& batch, const BatchAnswers& reference,
                      const TruthSettings& settings) {
  const std::size_t rays = batch.rays.size();
  Truth truth;
  if (static_cast<double>(rays) * cost_of_ray(scene) <= settings.test_budget) {
    truth.answers = brute_force(scene, batch.rays, batch.query);
    truth.proved.assign(rays, 1);
    truth.brute_forced = rays;
  } else {
    truth.answers = reference;
    truth.proved.assign(rays, 0);
    prove(scene, batch, sample_indices(rays, settings.sample, settings.seed), truth);
  }
  return truth;
}

std::size_t settle_disputes(const Scene& scene, const RayBatch& batch, const Row& row, Truth& truth,
                            const TruthSettings& settings) {
  const auto affordable = static_cast<std::size_t>(settings.test_budget / cost_of_ray(scene));
  std::vector<std::size_t> disputed;
  for (std::size_t ray = 0; ray < batch.rays.size() && disputed.size() < affordable; ++ray)
    if (!truth.proved[ray] && contradicts(scene, batch, truth.answers, row, ray)) disputed.push_back(ray);

  const BatchAnswers before = truth.answers;
  prove(scene, batch, disputed, truth);
  return static_cast<std::size_t>(std::count_if(disputed.begin(), disputed.end(), [&](std::size_t ray) {
    return !equal_at(before, truth.answers, batch.query, ray);
  }));
}

}  // namespace raymeter
