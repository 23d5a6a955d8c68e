#include "harness/truth.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <thread>

#include "accel/primitive_test.h"
#include "harness/dispute.h"
#include "scenes/base/float_mode.h"
#include "scenes/base/random.h"

namespace raymeter {
namespace {

float decide_primitive(const Scene& scene, std::uint32_t primitive, const FilterRay& ray) {
  Hit hit;
  NoProbe probe;
  test_closest(scene, primitive, ray, hit, probe);
  return hit.t;
}

/// Triangles laid out so that the compiler tests several at once.
struct TriangleBlock {
  static constexpr std::uint32_t size = 256;
  std::array<std::array<float, size>, 9> values;  // a, b - a, c - a
  std::array<std::int32_t, size> outside;

  void load(const Scene& scene, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Triangle triangle = scene.triangle(first + i);
      const Vec3 e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a;
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<std::size_t>(axis);
        values[row][i] = triangle.a[axis];
        values[3 + row][i] = e1[axis];
        values[6 + row][i] = e2[axis];
      }
    }
  }
  void filter(const FilterRay& ray, std::uint32_t count) {
    const Vec3 d = ray.direction, o = ray.ray.origin;
    const auto& [ax, ay, az, ex, ey, ez, fx, fy, fz] = values;
    for (std::uint32_t i = 0; i < count; ++i)
      outside[i] = filter::passes_outside(d, {o.x - ax[i], o.y - ay[i], o.z - az[i]}, {ex[i], ey[i], ez[i]},
                                          {fx[i], fy[i], fz[i]});
  }
};

/// Calls test(index of ray, its FilterRay, primitive) for every pair that is not certainly a miss, until it
/// returns true for the ray. A block of primitives stays in the cache while all rays are tested against it.
template <class Test>
void for_pairs(const Scene& scene, std::span<const Ray> rays, const Test& test) {
  struct PendingRay {
    std::size_t index;
    FilterRay filter;
  };
  std::vector<PendingRay> pending;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (is_traceable(rays[i])) pending.push_back({i, FilterRay(rays[i])});

  const auto block = std::make_unique<TriangleBlock>();
  const auto triangles = static_cast<std::uint32_t>(scene.triangle_count());
  for (std::uint32_t first = 0; first < triangles; first += TriangleBlock::size) {
    const std::uint32_t count = std::min(TriangleBlock::size, triangles - first);
    block->load(scene, first, count);
    std::erase_if(pending, [&](const PendingRay& ray) {
      block->filter(ray.filter, count);
      for (std::uint32_t i = 0; i < count; ++i)
        if (!block->outside[i] && test(ray.index, ray.filter, first + i)) return true;
      return false;
    });
  }
  const auto primitives = static_cast<std::uint32_t>(scene.primitive_count());
  for (const PendingRay& ray : pending)
    for (std::uint32_t quadric = triangles; quadric < primitives; ++quadric)
      if (test(ray.index, ray.filter, quadric)) break;
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

void count_bases(Truth& truth) {
  const auto of = [&](Basis basis) {
    return static_cast<std::size_t>(std::count(truth.basis.begin(), truth.basis.end(), basis));
  };
  truth.brute_forced = of(Basis::proved);
  truth.known = truth.basis.size() - of(Basis::unknown);
}

}  // namespace

BatchAnswers brute_force(const Scene& scene, std::span<const Ray> rays, QueryKind query) {
  BatchAnswers answers;
  if (query == QueryKind::closest)
    answers.hits.resize(rays.size());
  else
    answers.occluded.resize(rays.size());
  const std::size_t cpus = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t group = std::clamp<std::size_t>(rays.size() / (4 * cpus), 1, 128);
  tbb::parallel_for(std::size_t{0}, (rays.size() + group - 1) / group, [&](std::size_t index) {
    const FlushDenormals mode;
    const std::size_t first = index * group, count = std::min(group, rays.size() - first);
    if (query == QueryKind::closest) {
      const auto hits = std::span(answers.hits).subspan(first, count);
      for_pairs(scene, rays.subspan(first, count),
                [&](std::size_t ray, const FilterRay& filter, std::uint32_t p) {
                  NoProbe probe;
                  test_closest(scene, p, filter, hits[ray], probe);
                  return false;
                });
    } else {
      const auto occluded = std::span(answers.occluded).subspan(first, count);
      for_pairs(scene, rays.subspan(first, count),
                [&](std::size_t ray, const FilterRay& filter, std::uint32_t p) {
                  NoProbe probe;
                  if (!test_any(scene, p, filter, probe)) return false;
                  occluded[ray] = 1;
                  return true;
                });
    }
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

std::size_t settle_disputes(const Scene& scene, const RayBatch& batch, const Row& row, Truth& truth,
                            const TruthSettings& settings) {
  std::vector<std::size_t> disputed;
  for (std::size_t ray = 0; ray < batch.rays.size(); ++ray)
    if (truth.basis[ray] == Basis::agreed &&
        (row.policy == Answers::exact ? !equal_at(truth.answers, row.answers, batch.query, ray)
                                      : contradicts(scene, batch, truth.answers, row.answers, ray)))
      disputed.push_back(ray);
  // What is disputed beyond the budget stays open: nobody's answer is taken for true there.
  const double cost = std::max<double>(1, static_cast<double>(scene.primitive_count()));
  const auto affordable = static_cast<std::size_t>(settings.test_budget / cost);
  for (std::size_t i = affordable; i < disputed.size(); ++i) truth.basis[disputed[i]] = Basis::unknown;
  disputed.resize(std::min(disputed.size(), affordable));

  const BatchAnswers before = truth.answers;
  prove(scene, batch, disputed, truth);
  count_bases(truth);
  return static_cast<std::size_t>(std::count_if(disputed.begin(), disputed.end(), [&](std::size_t ray) {
    return !equal_at(before, truth.answers, batch.query, ray);
  }));
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
    const auto first =
        std::find_if(rows.begin(), rows.end(), [](const Row& row) { return row.policy == Answers::exact; });
    if (first != rows.end()) {
      truth.answers = first->answers;
      truth.basis.assign(rays, Basis::agreed);
    }
    prove(scene, batch, sample_indices(rays, settings.sample, settings.seed), truth);
    for (const Row& row : rows) settle_disputes(scene, batch, row, truth, settings);
  }
  count_bases(truth);
  return truth;
}

}  // namespace raymeter
