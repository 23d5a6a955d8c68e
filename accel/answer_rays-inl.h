// How the rays of a batch are answered, one by one where they are not traced together, for the instruction
// set of HWY_TARGET: included once for each.
#if defined(RAYMETER_ANSWER_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_ANSWER_RAYS_INL
#undef RAYMETER_ANSWER_RAYS_INL
#else
#define RAYMETER_ANSWER_RAYS_INL
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "accel/brick_walk-inl.h"
#include "accel/leaf_queries-inl.h"
#include "accel/structure.h"
#include "accel/walk_space.h"
#include "scenes/base/float_mode.h"
#include "scenes/geometry/rounding.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// What a ray finds in a leaf.
template <class Queries, class Probe>
HWY_INLINE void visit_leaf(const Leaf& leaf, const RayPacket& packet, std::size_t ray, Queries& queries,
                           Probe& probe) {
  const PacketMask one = PacketMask{1} << ray;
  for (std::uint32_t i = leaf.next_block(0); i < leaf.triangles; i = leaf.next_block(i + LeafWords::block)) {
    const TriangleRows rows = leaf.block(i);
    for (std::uint32_t first = 0; first < rows.count; first += lanes) {
      const LeafBlock block(rows, first);
      probe.test_block();
      if constexpr (!std::is_same_v<Probe, NoProbe>)
        for (std::uint32_t j = first; j < std::min<std::uint32_t>(rows.count, first + lanes); ++j)
          probe.test(rows.primitive(j));
      const BlockTest test = test_block(in_all_lanes(packet.origin, ray), in_all_lanes(packet.direction, ray),
                                        rows, first, leaf.reach);
      if (test.candidates == 0) continue;
      queries.consider_ray(block, ray, test);
      if ((queries.live() & one) == 0) return;
    }
  }
  if (!leaf.others.empty()) queries.consider_others(leaf.others, one);
}

/// How rays are taken to the leaves of a grid. `Tracer` has
///   walk(packet, v, which): a BrickWalk of these rays;
///   visit_roots(walk, packet, v, found, probe, visit): for the rays of vector v that were found at roots,
///     visit(leaf, ray) of the leaves that they meet, until it says that the ray is done.
/// Traces those rays of the packet for which RayPacket::load says that floats do.
template <class Tracer, class Queries, class Probe>
HWY_INLINE void trace_singly(const Tracer& tracer, const RayPacket& packet, PacketMask which,
                             Queries& queries, Probe& probe) {
  queries.begin(which);
  for (std::size_t v = 0; v < packet_vectors; ++v) {
    if (vector_bits(which, v) == 0) continue;
    BrickWalk walk = tracer.walk(packet, v, vector_bits(which, v));
    while (const std::uint64_t found = walk.next_roots(probe)) {
      // g++ calls what is not forced inline, for each leaf.
      tracer.visit_roots(walk, packet, v, found, probe,
                         [&](const Leaf& leaf, std::size_t ray) __attribute__((always_inline)) {
                           visit_leaf(leaf, packet, ray, queries, probe);
                           return (queries.live() >> ray & 1u) == 0;
                         });
      for (std::uint64_t rest = found; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        const std::size_t ray = v * lanes + lane;
        walk.end(lane,
                 queries.live() >> ray & 1u ? packet.after[ray] : -std::numeric_limits<float>::infinity());
      }
    }
  }
}

/// Traces a ray that floats don't do for, from where it enters the scene, if it only starts too far away.
/// False if there is more to it. `packet` has the ray as given, at `index`: what it asks of triangles is for
/// that.
template <class Tracer, class Queries, class Probe>
HWY_NOINLINE bool trace_from_afar(const Tracer& tracer, const FloatGrid& grid, const WalkSpace& space,
                                  const Ray& ray, const RayPacket& packet, std::size_t index,
                                  Queries& queries, Probe& probe) {
  const WalkRay walk_ray(ray);
  if (too_far(walk_ray, space)) return false;
  const WalkInterval interval = clip(walk_ray, ray, space.low, space.high);
  if (interval.empty()) return true;
  std::array<Ray, packet_size> moved;
  moved.fill(ray);
  moved[0].origin = to_float(walk_ray.origin + interval.enter * walk_ray.direction);
  if (moved[0].tnear > 0) moved[0].tnear = 0;
  moved[0].tfar = std::numeric_limits<float>::infinity();
  RoundedRay start;
  if ((start.load(moved.data(), grid) & 1u) == 0) return false;
  // Half a unit in the last place of any coordinate in the box; the grid's margin pays for that, too.
  double greatest = 0;
  for (int axis = 0; axis < 3; ++axis)
    greatest = std::max({greatest, std::abs(space.low[axis]), std::abs(space.high[axis])});
  start.margin = static_cast<float>(greatest * 0x1p-23);

  const double by = interval.enter * double(packet.scale[index]);
  // The 1-norm of the way.
  const float way = 2 * (1 + 0x1p-20f) * static_cast<float>(by);
  const auto end = [&] { start.after[0] = -float_below(by - double(packet.after[index])) * (1 + 0x1p-20f); };
  end();
  queries.begin(PacketMask{1} << index);
  BrickWalk walk = tracer.walk(start, 0, 1);
  while (walk.next_roots(probe) != 0) {
    tracer.visit_roots(walk, start, 0, 1, probe, [&](const Leaf& leaf, std::size_t) {
      Leaf seen = leaf;
      seen.reach += way;
      visit_leaf(seen, packet, index, queries, probe);
      end();
      return queries.live() == 0;
    });
    walk.end(0, queries.live() != 0 ? start.after[0] : -std::numeric_limits<float>::infinity());
  }
  return true;
}

/// Answers the first of packet_size rays, as many as there are answers. trace_some(packet, taken, queries):
/// traces what rays it wants of those that are taken, and returns them.
template <class Queries, class Tracer, class Answer, class Probe, class TraceSome>
HWY_INLINE void answer_rays(const Tracer& tracer, const FloatGrid& grid, const WalkSpace& space,
                            const Scene& scene, const Ray* rays, std::span<Answer> answers, Probe& probe,
                            const TraceSome& trace_some) {
  const PacketMask all = (PacketMask{1} << answers.size()) - 1;
  RayPacket packet;
  const PacketMask taken = packet.load(rays, grid) & all;
  Queries queries(scene, rays, packet, probe);
  const PacketMask singly = taken & ~trace_some(packet, taken, queries);
  if constexpr (std::is_same_v<Probe, NoProbe>)
    trace_singly(tracer, packet, singly, queries, probe);
  else  // a probe counts the rays that are walked together as if they were one
    for_each_ray(singly, [&](std::size_t ray) {
      probe.select(ray);
      trace_singly(tracer, packet, PacketMask{1} << ray, queries, probe);
    });
  PacketMask others = 0;
  for_each_ray(all & ~taken, [&](std::size_t ray) {
    probe.select(ray);
    if (is_traceable(rays[ray]) &&
        !trace_from_afar(tracer, grid, space, rays[ray], packet, ray, queries, probe))
      others |= PacketMask{1} << ray;
  });
  queries.finish();
  for (std::size_t i = 0; i < answers.size(); ++i) answers[i] = queries.answer(i);
  for_each_ray(others, [&](std::size_t ray) {
    probe.select(ray);
    if constexpr (std::is_same_v<Answer, Hit>)
      answers[ray] = closest_of_all(scene, rays[ray], probe);
    else
      answers[ray] = any_of_all(scene, rays[ray], probe);
  });
}

/// Answers the rays of a batch. `counters`: one for each ray, if the probe counts.
template <class Queries, class Tracer, class Answer, class Probe, class TraceSome>
HWY_INLINE void answer_batch(const Tracer& tracer, const FloatGrid& grid, const WalkSpace& space,
                             const Scene& scene, const BatchView& batch, std::span<Answer> answers,
                             [[maybe_unused]] std::span<RayCounters> counters, Probe& probe,
                             const TraceSome& trace_some) {
  const FlushDenormals mode;
  std::array<Ray, packet_size> last;  // padded
  for (std::size_t i = 0; i < batch.rays.size(); i += packet_size) {
    const std::size_t n = std::min(packet_size, batch.rays.size() - i);
    if constexpr (!std::is_same_v<Probe, NoProbe>) probe.begin_rays(counters.subspan(i, n));
    const Ray* rays = &batch.rays[i];
    if (n < packet_size) {
      std::ranges::copy(batch.rays.subspan(i, n), last.begin());
      rays = last.data();
    }
    answer_rays<Queries>(tracer, grid, space, scene, rays, answers.subspan(i, n), probe, trace_some);
  }
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
