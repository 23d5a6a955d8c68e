// What a ray asks of the leaves that it meets, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_LEAF_QUERIES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_LEAF_QUERIES_INL
#undef RAYMETER_LEAF_QUERIES_INL
#else
#define RAYMETER_LEAF_QUERIES_INL
#endif

#include <bit>
#include <limits>
#include <span>
#include <type_traits>

#include "accel/brick_ray-inl.h"
#include "accel/brick_walk-inl.h"
#include "accel/primitive_test.h"
#include "accel/triangle_block-inl.h"
#include "accel/walk_space.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// A leaf that a ray meets, and how far from its origin some point of each primitive may be (1-norm).
struct Leaf {
  const std::uint32_t* words = nullptr;
  std::uint32_t triangles = 0;  ///< how many
  std::span<const std::uint32_t> others;
  float reach = 0;
  std::uint64_t pierced = 0;  ///< cells

  /// The first triangle of the first block from there on that may be hit, or the number of triangles.
  HWY_INLINE std::uint32_t next_block(std::uint32_t first) const {
    while (first < triangles && (pierced & LeafWords::cells(words, triangles, first)) == 0)
      first += LeafWords::block;
    return first;
  }
  TriangleRows block(std::uint32_t first) const { return LeafWords::rows(words, triangles, first); }
};

template <class Probe>
HWY_INLINE void count_block(const TriangleRows& triangles, std::uint32_t first, Probe& probe) {
  probe.test_block();
  if constexpr (!std::is_same_v<Probe, NoProbe>)
    for (std::uint32_t i = first; i < std::min<std::uint32_t>(triangles.count, first + lanes); ++i)
      probe.test(triangles.primitive(i));
}

/// The closest hit.
template <class Probe>
class ClosestHit {
 public:
  HWY_INLINE ClosestHit(const Scene& scene, const BrickRay& ray, Probe& probe)
      : scene_(scene), ray_(ray), probe_(probe), interval_(ray) {}

  /// What lies beyond doesn't matter.
  float tmax() const { return interval_.after; }

  HWY_INLINE void visit(const Leaf& leaf) {
    for (std::uint32_t i = leaf.next_block(0); i < leaf.triangles;
         i = leaf.next_block(i + LeafWords::block)) {
      const TriangleRows block = leaf.block(i);
      for (std::uint32_t first = 0; first < block.count; first += lanes) {
        count_block(block, first, probe_);
        const BlockTest test = test_block(ray_, block, first, leaf.reach);
        if (test.candidates == 0) continue;
        std::uint64_t candidates = test.within(interval_).possible;
        for (; candidates != 0; candidates &= candidates - 1) {
          const auto lane = static_cast<unsigned>(std::countr_zero(candidates));
          const std::uint32_t primitive = block.primitive(first + lane);
          if (primitive != best_.primitive)
            consider(primitive, block, first + lane, (test.inside() >> lane & 1u) != 0, leaf.reach);
        }
      }
    }
    if (!leaf.others.empty()) visit_others(leaf.others);
  }
  static constexpr bool done() { return false; }
  Hit answer() const { return best_; }

 private:
  HWY_INLINE void consider(std::uint32_t primitive, const TriangleRows& triangles, std::uint32_t column,
                           bool inside, float reach) {
    const Triangle triangle = triangles.triangle(column);
    const PlaneHit plane(ray_, triangle, triangles.edge(column), reach);
    const Ray& ray = *ray_.ray;
    if (plane.known()) {
      const double inverse = 1 / plane.det, t = plane.height * inverse;
      const double error =
          1.01 * (plane.height_error + std::abs(t) * plane.det_error) * inverse + 0x1p-50 * std::abs(t);
      const float low = rounded(t - error), high = rounded(t + error);
      if (low > std::min(best_.t, ray.tfar) || high <= ray.tnear) return;
      if (low == high && inside) {
        probe_.decide();
        return take(within(ray, low), primitive);
      }
    }
    probe_.decide();
    take(decide(ray, triangle), primitive);
  }
  HWY_INLINE void take(float t, std::uint32_t primitive) {
    if (t == no_hit || !(Hit{t, primitive} < best_)) return;
    best_ = {t, primitive};
    interval_.after = ray_.scaled_up(t);
  }
  HWY_NOINLINE void visit_others(std::span<const std::uint32_t> others) {
    const FilterRay filter(*ray_.ray);
    for (const std::uint32_t primitive : others) test_closest(scene_, primitive, filter, best_, probe_);
    if (best_.found()) interval_.after = ray_.scaled_up(best_.t);
  }

  const Scene& scene_;
  const BrickRay& ray_;
  Probe& probe_;
  FilterInterval interval_;
  Hit best_;
};

/// Whether there is any hit.
template <class Probe>
class AnyHit {
 public:
  HWY_INLINE AnyHit(const Scene& scene, const BrickRay& ray, Probe& probe)
      : scene_(scene), ray_(ray), probe_(probe), interval_(ray) {}

  float tmax() const { return interval_.after; }

  HWY_INLINE void visit(const Leaf& leaf) {
    for (std::uint32_t i = leaf.next_block(0); i < leaf.triangles;
         i = leaf.next_block(i + LeafWords::block)) {
      const TriangleRows block = leaf.block(i);
      for (std::uint32_t first = 0; first < block.count && !hit_; first += lanes) {
        count_block(block, first, probe_);
        const BlockTest test = test_block(ray_, block, first, leaf.reach);
        if (test.candidates == 0) continue;
        const auto [possible, certain] = test.within(interval_);
        hit_ = certain != 0;
        for (std::uint64_t candidates = possible; candidates != 0 && !hit_; candidates &= candidates - 1) {
          const auto lane = static_cast<unsigned>(std::countr_zero(candidates));
          probe_.decide();
          hit_ = decide_any(ray_, block, first + lane, (test.inside() >> lane & 1u) != 0, leaf.reach);
        }
      }
      if (hit_) return found();
    }
    if (!leaf.others.empty()) visit_others(leaf.others);
  }
  bool done() const { return hit_; }
  std::uint8_t answer() const { return hit_; }

 private:
  /// Nothing else matters.
  HWY_INLINE void found() {
    hit_ = true;
    interval_.after = -std::numeric_limits<float>::infinity();
  }
  HWY_NOINLINE void visit_others(std::span<const std::uint32_t> others) {
    const FilterRay filter(*ray_.ray);
    for (std::size_t i = 0; i < others.size() && !hit_; ++i)
      hit_ = test_any(scene_, others[i], filter, probe_);
    if (hit_) found();
  }

  const Scene& scene_;
  const BrickRay& ray_;
  Probe& probe_;
  FilterInterval interval_;
  bool hit_ = false;
};

/// A query of a ray, asked by the same ray with its origin moved along.
template <class Query>
class MovedQuery {
 public:
  /// `moved` begins where `ray` is at t = `by` of its given direction.
  MovedQuery(Query& query, const BrickRay& ray, double by)
      : query_(query), by_(by * ray.scale), moved_(2 * (1 + 0x1p-20f) * static_cast<float>(by_)) {}
  float tmax() const { return -float_below(by_ - double(query_.tmax())) * (1 + 0x1p-20f); }
  void visit(const Leaf& leaf) {
    Leaf seen = leaf;
    seen.reach += moved_;
    query_.visit(seen);
  }
  bool done() const { return query_.done(); }

 private:
  Query& query_;
  double by_;    // in scaled t
  float moved_;  // the 1-norm
};

/// For a ray that BrickWalk is not proved for: from where it enters the scene, if that is all, else without a
/// walk. visit_root(walk, query): what there is to do at a root for the walk's only ray.
template <class Query, class Answer, class Grid, class Probe, class VisitRoot>
HWY_NOINLINE Answer answer_special(const Grid& grid, const Scene& scene, const Ray& ray, Probe& probe,
                                   const VisitRoot& visit_root) {
  if (!is_traceable(ray)) return {};
  const WalkRay walk_ray(ray);
  if (!too_far(walk_ray, grid.space)) {
    const WalkInterval interval = clip(walk_ray, ray, grid.space.low, grid.space.high);
    if (interval.empty()) return {};
    Ray moved = ray;
    moved.origin = to_float(walk_ray.origin + interval.enter * walk_ray.direction);
    if (moved.tnear > 0) moved.tnear = 0;
    moved.tfar = std::numeric_limits<float>::infinity();
    BrickWalk walk(grid, {&moved, 1});
    if (walk.taken() != 0) {
      BrickRay unmoved = walk.ray(0);
      unmoved.ray = &ray;
      Query query(scene, unmoved, probe);
      MovedQuery<Query> moved_query(query, unmoved, interval.enter);
      while (walk.next_roots(probe) != 0) {
        visit_root(walk, moved_query);
        walk.end(0, moved_query.tmax());
      }
      return query.answer();
    }
  }
  if constexpr (std::is_same_v<Answer, Hit>)
    return closest_of_all(scene, ray, probe);
  else
    return any_of_all(scene, ray, probe);
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
