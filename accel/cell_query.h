#pragma once
// What a ray asks of the cells that it pierces, the same for every grid: test the primitives of a cell, and
// say how far the walk must go on.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "accel/mailbox.h"
#include "accel/primitive_test.h"
#include "accel/walk_space.h"
#include "scenes/geometry/filter.h"
#include "scenes/geometry/ray.h"
#include "scenes/scene.h"

namespace raymeter {

/// The closest hit.
template <class Mailbox, class Probe>
class ClosestQuery {
 public:
  using Answer = Hit;

  /// `leave`: where the walk ends if nothing is hit.
  ClosestQuery(const Scene& scene, const Ray& ray, double leave, Probe& probe)
      : scene_(scene), ray_(ray), last_(leave), probe_(probe) {}

  void visit(std::span<const std::uint32_t> primitives) {
    probe_.cell_step(primitives.empty());
    if (primitives.empty()) return;
    for (const std::uint32_t p : primitives)
      if (mailbox_.is_new(p)) test_closest(scene_, p, ray_, best_, probe_);
    // A hit may lie beyond this cell: it stands, and the walk goes on until nothing can beat it.
    if (best_.found()) last_ = std::min(last_, latest(best_.t));
  }
  /// Cells entered later than this don't matter.
  double last() const { return last_; }
  Hit answer() const { return best_; }

 private:
  const Scene& scene_;
  FilterRay ray_;
  Hit best_;
  double last_;
  [[no_unique_address]] Mailbox mailbox_;
  Probe& probe_;
};

/// Whether there is any hit.
template <class Mailbox, class Probe>
class AnyQuery {
 public:
  using Answer = bool;

  AnyQuery(const Scene& scene, const Ray& ray, double leave, Probe& probe)
      : scene_(scene), ray_(ray), last_(leave), probe_(probe) {}

  void visit(std::span<const std::uint32_t> primitives) {
    probe_.cell_step(primitives.empty());
    for (const std::uint32_t p : primitives)
      if (mailbox_.is_new(p) && test_any(scene_, p, ray_, probe_)) {
        hit_ = true;
        last_ = -std::numeric_limits<double>::infinity();
        return;
      }
  }
  double last() const { return last_; }
  bool answer() const { return hit_; }

 private:
  const Scene& scene_;
  FilterRay ray_;
  bool hit_ = false;
  double last_;
  [[no_unique_address]] Mailbox mailbox_;
  Probe& probe_;
};

/// Answers a ray by walk(walk_ray, interval, query), which must let the query visit the cells within
/// `interval` until query.last(). Rays that can't be walked are answered without.
template <class Query, class Probe, class Walk>
inline typename Query::Answer answer_by_walk(const Scene& scene, const WalkSpace& space, const Ray& ray,
                                             Probe& probe, const Walk& walk) {
  if (!is_traceable(ray)) return {};
  const WalkRay walk_ray(ray);
  if (too_far(walk_ray, space)) {
    if constexpr (std::is_same_v<typename Query::Answer, Hit>)
      return closest_of_all(scene, ray, probe);
    else
      return any_of_all(scene, ray, probe);
  }
  const WalkInterval interval = clip(walk_ray, ray, space.low, space.high);
  if (interval.empty()) return {};
  Query query(scene, ray, interval.leave, probe);
  walk(walk_ray, interval, query);
  return query.answer();
}

}  // namespace raymeter
