#include "harness/truth.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

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

bool equal_at(const BatchAnswers& a, const BatchAnswers& b, QueryKind query, std::size_t ray) {
  return query == QueryKind::closest ? a.hits[ray] == b.hits[ray] : a.occluded[ray] == b.occluded[ray];
}

/// Whether a row that may differ in the last bits contradicts the candidate by more than those.
bool contradicts(const Scene& scene, const RayBatch& batch, const BatchAnswers& candidate,
                 const BatchAnswers& row, std::size_t ray) {
  if (equal_at(candidate, row, batch.query, ray)) return false;
  if (batch.query == QueryKind::any) return row.occluded[ray] != occlusion_not_answered;
  const Hit &a = candidate.hits[ray], &b = row.hits[ray];
  if (b.primitive == not_answered) return false;
  if (!a.found() || a.primitive != b.primitive) return a.found() || b.found();
  return !(std::abs(double(a.t) - double(b.t)) <= t_bound(scene, batch.rays[ray], a.primitive, a.t));
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
    if (truth.basis[i] != Basis::proved) {
      open.push_back(i);
      rays.push_back(batch.rays[i]);
    }
  const BatchAnswers proved = brute_force(scene, rays, batch.query);
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (batch.query == QueryKind::closest)
      truth.answers.hits[open[i]] = proved.hits[i];
    else
      truth.answers.occluded[open[i]] = proved.occluded[i];
    truth.basis[open[i]] = Basis::proved;
  }
}

}  // namespace

BatchAnswers brute_force(const Scene& scene, std::span<const Ray> rays, QueryKind query) {
  const StructureKind kind = brute_force_kind();
  const auto structure = kind.build(Arguments(Spec{kind.name, {}}, kind.parameters), {scene});
  BatchAnswers answers;
  trace(*structure, {.rays = rays, .query = query}, answers,
        std::max(1u, std::thread::hardware_concurrency()));
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

Truth establish_truth(const Scene& scene, const RayBatch& batch, std::span<const Row> rows,
                      const TruthSettings& settings) {
  const std::size_t rays = batch.rays.size();
  const double cost = std::max<double>(1, static_cast<double>(scene.primitive_count()));
  Truth truth;
  truth.basis.assign(rays, Basis::unknown);
  if (batch.query == QueryKind::closest)
    truth.answers.hits.resize(rays);
  else
    truth.answers.occluded.resize(rays);

  if (static_cast<double>(rays) * cost <= settings.test_budget) {
    // A small scene: every ray is proved.
    truth.answers = brute_force(scene, batch.rays, batch.query);
    truth.basis.assign(rays, Basis::proved);
  } else {
    // Where the exact rows agree, their answer is the candidate. The first of them stands for all.
    std::vector<std::size_t> disputed;
    const auto first =
        std::find_if(rows.begin(), rows.end(), [](const Row& row) { return row.policy == Answers::exact; });
    if (first != rows.end()) {
      truth.answers = first->answers;
      truth.basis.assign(rays, Basis::agreed);
      for (std::size_t ray = 0; ray < rays; ++ray) {
        const bool doubted = std::any_of(rows.begin(), rows.end(), [&](const Row& row) {
          return row.policy == Answers::exact ? !equal_at(truth.answers, row.answers, batch.query, ray)
                                              : contradicts(scene, batch, truth.answers, row.answers, ray);
        });
        if (doubted) disputed.push_back(ray);
      }
    }
    prove(scene, batch, sample_indices(rays, settings.sample, settings.seed), truth);
    // What is disputed beyond the budget stays open: nobody's answer is taken for true there.
    const auto affordable = static_cast<std::size_t>(settings.test_budget / cost);
    for (std::size_t i = affordable; i < disputed.size(); ++i)
      if (truth.basis[disputed[i]] != Basis::proved) truth.basis[disputed[i]] = Basis::unknown;
    disputed.resize(std::min(disputed.size(), affordable));
    prove(scene, batch, disputed, truth);
  }
  truth.brute_forced =
      static_cast<std::size_t>(std::count(truth.basis.begin(), truth.basis.end(), Basis::proved));
  truth.known =
      rays - static_cast<std::size_t>(std::count(truth.basis.begin(), truth.basis.end(), Basis::unknown));
  return truth;
}

}  // namespace raymeter
