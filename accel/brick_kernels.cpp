#include "accel/brick_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/brick_kernels.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <bit>
#include <limits>
#include <type_traits>

#include "accel/brick_ray-inl.h"
#include "accel/grid_walk.h"
#include "accel/primitive_test.h"
#include "accel/triangle_block-inl.h"
#include "scenes/base/float_mode.h"

// Of the dozen instruction sets that Highway knows, the three between which speed differs much.
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

/// What both queries know of their ray.
class Query {
 public:
  Query(const Scene& scene, const Ray& ray) : scene_(scene), ray_(ray), interval_(ray_) {}

  const FilterRay& ray() const { return ray_; }
  float tnear() const { return interval_.before; }
  /// Cells entered later than this don't matter.
  float tmax() const { return interval_.after; }
  /// The same for a walk.
  double last() const { return interval_.after / ray_.scale; }

 protected:
  const Scene& scene_;
  FilterRay ray_;
  FilterInterval interval_;
};

/// A leaf's words (bricks.h).
struct Leaf {
  const std::uint32_t* words = nullptr;
  std::uint32_t triangles = 0, others = 0;

  std::uint32_t triangle(std::uint32_t i) const { return words[9 * triangles + i]; }
  std::uint32_t other(std::uint32_t i) const { return words[10 * triangles + i]; }
  Triangle corners(std::uint32_t i) const {
    const auto number = [&](std::uint32_t row) { return std::bit_cast<float>(words[row * triangles + i]); };
    const auto corner = [&](std::uint32_t row) {
      return Vec3{number(row), number(row + 1), number(row + 2)};
    };
    return {corner(0), corner(3), corner(6)};
  }
};

template <class Probe>
HWY_INLINE void count_block(const Leaf& leaf, std::uint32_t first, Probe& probe) {
  probe.test_block();
  if constexpr (!std::is_same_v<Probe, NoProbe>)
    for (std::uint32_t i = first; i < std::min<std::uint32_t>(leaf.triangles, first + lanes); ++i)
      probe.test(leaf.triangle(i));
}

/// The closest hit. The primitive that is certainly hit, and certainly before all others so far, is decided
/// in the end: how near it is, is known well enough to end the walk.
template <class Probe>
class ClosestHit : public Query {
 public:
  ClosestHit(const Scene& scene, const Ray& ray, Probe& probe) : Query(scene, ray), probe_(probe) {}

  void visit(const Leaf& leaf) {
    for (std::uint32_t first = 0; first < leaf.triangles; first += lanes) {
      count_block(leaf, first, probe_);
      const BlockTest test = test_block(ray_, leaf.words, leaf.triangles, first, interval_);
      std::uint64_t candidates = bits_of(test.candidates);
      if (candidates == 0) continue;
      const std::uint64_t certain = bits_of(test.certain), inside = bits_of(test.inside);
      alignas(64) float least[lanes], greatest[lanes];
      hn::Store(test.least_t(), Floats(), least);
      hn::Store(test.greatest_t(), Floats(), greatest);
      for (; candidates != 0; candidates &= candidates - 1) {
        const auto lane = static_cast<unsigned>(std::countr_zero(candidates));
        const Candidate candidate{leaf.triangle(first + lane), leaf,        first + lane,
                                  (inside >> lane & 1u) != 0,  least[lane], greatest[lane]};
        consider(candidate, (certain >> lane & 1u) != 0);
      }
    }
    for (std::uint32_t i = 0; i < leaf.others; ++i) {
      const std::uint32_t primitive = leaf.other(i);
      probe_.test(primitive);
      if (primitive == best_.primitive) continue;
      const float tmax = std::min(best_.t, ray_.ray.tfar);
      const float t = scene_.visit(primitive, [&](const auto& shape) {
        if (!may_hit(ray_, shape, tmax)) return no_hit;
        probe_.decide();
        return decide(ray_.ray, shape);
      });
      take(t, primitive);
    }
  }
  static constexpr bool done() { return false; }
  Hit answer() {
    settle();
    return best_;
  }

 private:
  struct Candidate {
    std::uint32_t primitive = no_primitive;
    Leaf leaf = {};
    std::uint32_t place = 0;  // in the leaf
    bool inside = false;      // BlockTest
    float least = std::numeric_limits<float>::infinity(),
          greatest = 0;  // bounds of a certain one's t, scaled
  };

  void consider(const Candidate& candidate, bool certain) {
    if (candidate.primitive == pending_.primitive || candidate.primitive == best_.primitive) return;
    if (certain) {
      if (candidate.greatest < pending_.least && candidate.greatest < best_least_) {
        pending_ = candidate;
        interval_.after = candidate.greatest;
        return;
      }
      if (candidate.least > interval_.after) return;
    }
    settle();
    decide_on(candidate);
  }
  void settle() {
    if (pending_.primitive == no_primitive) return;
    decide_on(pending_);
    pending_ = {};
  }
  void decide_on(const Candidate& candidate) {
    probe_.decide();
    const Triangle triangle = candidate.leaf.corners(candidate.place);
    take(candidate.inside ? decide_inside(ray_.ray, triangle) : decide(ray_.ray, triangle),
         candidate.primitive);
  }
  void take(float t, std::uint32_t primitive) {
    if (t == no_hit || !(Hit{t, primitive} < best_)) return;
    best_ = {t, primitive};
    best_least_ = scaled_down(ray_, t);
    interval_.after = std::min(interval_.after, scaled_up(ray_, t));
  }

  Candidate pending_;
  Hit best_;
  float best_least_ = std::numeric_limits<float>::infinity();  // of best_.t, scaled
  Probe& probe_;
};

/// Whether there is any hit.
template <class Probe>
class AnyHit : public Query {
 public:
  AnyHit(const Scene& scene, const Ray& ray, Probe& probe) : Query(scene, ray), probe_(probe) {}

  void visit(const Leaf& leaf) {
    for (std::uint32_t first = 0; first < leaf.triangles && !hit_; first += lanes) {
      count_block(leaf, first, probe_);
      const BlockTest test = test_block(ray_, leaf.words, leaf.triangles, first, interval_);
      hit_ = !hn::AllFalse(Floats(), test.certain);
      const std::uint64_t inside = bits_of(test.inside);
      for (std::uint64_t candidates = bits_of(test.candidates); candidates != 0 && !hit_;
           candidates &= candidates - 1) {
        const auto lane = static_cast<unsigned>(std::countr_zero(candidates));
        probe_.decide();
        const Triangle triangle = leaf.corners(first + lane);
        hit_ =
            (inside >> lane & 1u ? decide_inside(ray_.ray, triangle) : decide(ray_.ray, triangle)) != no_hit;
      }
    }
    for (std::uint32_t i = 0; i < leaf.others && !hit_; ++i)
      hit_ = test_any(scene_, leaf.other(i), ray_, probe_);
  }
  bool done() const { return hit_; }
  bool answer() const { return hit_; }

 private:
  bool hit_ = false;
  Probe& probe_;
};

/// Visits the leaves below a root that the ray meets, front to back.
template <class Query, class Probe>
HWY_NOINLINE void walk_bricks(const Bricks& bricks, std::uint32_t root, const BrickRay& ray, Query& query,
                              Probe& probe) {
  struct Level {
    std::uint64_t rest;  // cells still to be visited, as BrickRay::pierced gives them
    std::uint32_t node;
    float tmax;  // for which that was found
  };
  Level stack[deepest_brick + 1];
  std::uint32_t depth = 0, index = root;
  while (true) {
    const BrickNode& node = bricks.nodes[index];
    const std::uint64_t cells = ray.pierced(node, query.tnear(), query.tmax());
    if (cells == 0 || !node.is_leaf()) {
      probe.inner_step();
      if (cells != 0) stack[depth++] = {cells, index, query.tmax()};
    } else {
      probe.cell_step(false);
      query.visit({bricks.words.data() + node.base, node.triangles, node.others});
      if (query.done()) return;
    }
    // The next cell of the innermost brick that has one left; after a hit, only of those before it.
    while (true) {
      if (depth == 0) return;
      Level& level = stack[depth - 1];
      if (level.rest != 0 && level.tmax != query.tmax()) {
        level.tmax = query.tmax();
        level.rest &= ray.pierced(bricks.nodes[level.node], query.tnear(), level.tmax);
      }
      if (level.rest != 0) break;
      --depth;
    }
    Level& level = stack[depth - 1];
    const auto cell = static_cast<unsigned>(std::countr_zero(level.rest)) ^ ray.mirror();
    level.rest &= level.rest - 1;
    index = bricks.nodes[level.node].child(cell);
  }
}

template <class Query, class Answer, class Probe>
HWY_INLINE Answer answer(const Bricks& bricks, const Scene& scene, const Ray& ray, Probe& probe) {
  if (!is_traceable(ray)) return {};
  const WalkRay walk(ray);
  Query query(scene, ray, probe);
  if (!BrickRay::takes(query.ray()) || too_far(walk, bricks.space)) {
    if constexpr (std::is_same_v<Answer, Hit>)
      return closest_of_all(scene, ray, probe);
    else
      return any_of_all(scene, ray, probe);
  }
  const WalkInterval interval = clip(walk, ray, bricks.space.low, bricks.space.high);
  if (interval.empty()) return {};
  const BrickRay brick_ray(query.ray());
  walk_cells(bricks.grid, walk, interval, [&](std::uint64_t cell, double, double) {
    const std::uint32_t root = bricks.roots[cell];
    if (root == Bricks::empty_cell) {
      probe.cell_step(true);
    } else {
      walk_bricks(bricks, root, brick_ray, query, probe);
      if (query.done()) return -std::numeric_limits<double>::infinity();
    }
    return query.last();
  });
  return query.answer();
}

void trace_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, std::span<Hit> hits) {
  const FlushDenormals mode;
  NoProbe probe;
  for (std::size_t i = 0; i < batch.rays.size(); ++i)
    hits[i] = answer<ClosestHit<NoProbe>, Hit>(bricks, scene, batch.rays[i], probe);
}
void trace_any(const Bricks& bricks, const Scene& scene, const BatchView& batch,
               std::span<std::uint8_t> occluded) {
  const FlushDenormals mode;
  NoProbe probe;
  for (std::size_t i = 0; i < batch.rays.size(); ++i)
    occluded[i] = answer<AnyHit<NoProbe>, bool>(bricks, scene, batch.rays[i], probe);
}
void count_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, std::span<Hit> hits,
                   std::span<RayCounters> counters) {
  const FlushDenormals mode;
  CountingProbe probe(scene.primitive_count());
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    probe.begin_ray(counters[i]);
    hits[i] = answer<ClosestHit<CountingProbe>, Hit>(bricks, scene, batch.rays[i], probe);
  }
}
void count_any(const Bricks& bricks, const Scene& scene, const BatchView& batch,
               std::span<std::uint8_t> occluded, std::span<RayCounters> counters) {
  const FlushDenormals mode;
  CountingProbe probe(scene.primitive_count());
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    probe.begin_ray(counters[i]);
    occluded[i] = answer<AnyHit<CountingProbe>, bool>(bricks, scene, batch.rays[i], probe);
  }
}

std::uint32_t sums_within(const std::array<float, 4>& a, const std::array<float, 4>& b, float low,
                          float high) {
  const Floats d;
  const FloatVector from = hn::Set(d, low), to = hn::Set(d, high), columns = hn::LoadDup128(d, a.data());
  alignas(64) std::array<float, 16> rows;
  for (std::size_t i = 0; i < 16; ++i) rows[i] = b[i / 4];
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 16; i += lanes) {
    const FloatVector sum = hn::Add(columns, hn::Load(d, &rows[i]));
    bits |= bits_of(hn::And(hn::Ge(sum, from), hn::Le(sum, to))) << i;
  }
  return static_cast<std::uint32_t>(bits);
}

}  // namespace

const BrickKernels& target_kernels() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse4.2";
  static constexpr BrickKernels kernels{isa, trace_closest, trace_any, count_closest, count_any, sums_within};
  return kernels;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace raymeter {

std::vector<const BrickKernels*> brick_kernels() {
  std::vector<const BrickKernels*> kernels;
#if HWY_ARCH_X86
  const auto supported = hwy::SupportedTargets();
  if (supported & HWY_AVX3) kernels.push_back(&N_AVX3::target_kernels());
  if (supported & HWY_AVX2) kernels.push_back(&N_AVX2::target_kernels());
  if (supported & HWY_SSE4) kernels.push_back(&N_SSE4::target_kernels());
#endif
  return kernels;
}

}  // namespace raymeter
#endif
