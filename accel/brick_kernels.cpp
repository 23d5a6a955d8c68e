#include "accel/brick_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/brick_kernels.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <bit>
#include <limits>
#include <type_traits>

#include "accel/brick_packet-inl.h"
#include "accel/brick_ray-inl.h"
#include "accel/brick_walk-inl.h"
#include "accel/leaf_queries-inl.h"
#include "scenes/base/float_mode.h"

// Of the dozen instruction sets that Highway knows, the three between which speed differs much.
#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

HWY_INLINE Leaf leaf_of(const Bricks& bricks, const BrickNode& node, float reach, std::uint64_t pierced) {
  const std::uint32_t* const words = bricks.words.data() + node.base;
  return {words, node.triangles, {words + LeafWords::count(node.triangles), node.others}, reach, pierced};
}

/// Visits the leaves below a root that the ray meets, front to back.
class TreeWalk {
 public:
  /// `reach`: as of BrickWalk.
  HWY_INLINE void begin(const BrickNode* root, float reach) {
    depth_ = 0;
    reach_ = reach;
    node_ = root;
    __builtin_prefetch(node_);
  }
  /// One node; false when there is no further one.
  template <class Query, class Probe>
  HWY_INLINE bool step(const Bricks& bricks, const BrickRay& ray, float tnear, Query& query, Probe& probe) {
    const BrickNode& node = *node_;
    const std::uint64_t cells = ray.pierced(node, tnear, query.tmax());
    if (cells != 0 && node.is_leaf()) {
      probe.cell_step(false);
      query.visit(leaf_of(bricks, node, reach_, cells));
      if (query.done()) return false;
    } else {
      probe.inner_step();
      if (cells != 0) stack_[depth_++] = {mirrored(cells, ray.octant), &node, query.tmax()};
    }
    // The next cell of the innermost brick that has one left; after a hit, only of those before it.
    while (true) {
      if (depth_ == 0) return false;
      Level& level = stack_[depth_ - 1];
      if (level.rest != 0 && level.tmax != query.tmax()) {
        level.tmax = query.tmax();
        level.rest &= mirrored(ray.pierced(*level.node, tnear, level.tmax), ray.octant);
      }
      if (level.rest != 0) break;
      --depth_;
    }
    Level& level = stack_[depth_ - 1];
    const auto cell = static_cast<unsigned>(std::countr_zero(level.rest)) ^ mirror_of[ray.octant];
    level.rest &= level.rest - 1;
    node_ = &bricks.nodes[level.node->child(cell)];
    __builtin_prefetch(node_);
    return true;
  }

 private:
  struct Level {
    std::uint64_t rest;  // cells still to be visited, as BrickRay::pierced gives them
    const BrickNode* node;
    float tmax;  // for which that was found
  };
  const BrickNode* node_;
  float reach_;
  std::uint32_t depth_;
  Level stack_[deepest_brick + 1];
};

/// Answers as many rays as there are lanes, or fewer. A probe counts them as if they were one.
template <class Query, class Answer, class Probe>
HWY_INLINE void answer_all(const Bricks& bricks, const Scene& scene, std::span<const Ray> rays,
                           std::span<Answer> answers, Probe& probe) {
  BrickWalk walk(bricks, rays);
  alignas(Query) std::array<std::byte, sizeof(Query) * lanes> storage;
  Query* const queries = reinterpret_cast<Query*>(storage.data());
  for (std::size_t i = 0; i < rays.size(); ++i) new (&queries[i]) Query(scene, walk.ray(i), probe);
  std::array<TreeWalk, lanes> trees;
  while (const std::uint64_t rest = walk.next_roots(probe)) {
    for (std::uint64_t r = rest; r != 0; r &= r - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(r));
      trees[lane].begin(&bricks.nodes[walk.root(lane)], walk.reach(lane));
    }
    for (std::uint64_t active = rest; active != 0;) {
      for (std::uint64_t r = active; r != 0; r &= r - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(r));
        if (!trees[lane].step(bricks, walk.ray(lane), walk.tnear(lane), queries[lane], probe))
          active &= ~(std::uint64_t{1} << lane);
      }
    }
    for (std::uint64_t r = rest; r != 0; r &= r - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(r));
      walk.end(lane, queries[lane].tmax());
    }
  }
  for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = queries[i].answer();
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - rays.size());
  for (std::uint64_t rest = all & ~walk.taken(); rest != 0; rest &= rest - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
    answers[lane] = answer_special<Query, Answer>(
        bricks, scene, rays[lane], probe, [&](const BrickWalk& special, auto& query) {
          TreeWalk tree;
          tree.begin(&bricks.nodes[special.root(0)], special.reach(0));
          while (tree.step(bricks, special.ray(0), special.tnear(0), query, probe)) {
          }
        });
  }
}

/// How many rays are given to answer_all at once.
template <class Probe>
inline constexpr std::size_t at_once = std::is_same_v<Probe, NoProbe> ? lanes : 1;

/// Answers those of packet_size rays that are in no packet.
template <class Query, class Answer, class Probe>
HWY_NOINLINE void answer_others(const Bricks& bricks, const Scene& scene, const Ray* rays, PacketMask which,
                                Answer* answers, Probe& probe) {
  while (which != 0) {
    std::array<Ray, at_once<Probe>> some;
    std::array<Answer, at_once<Probe>> theirs;
    std::array<std::size_t, at_once<Probe>> places;
    std::size_t n = 0;
    for (; n < some.size() && which != 0; which &= which - 1) {
      places[n] = static_cast<std::size_t>(std::countr_zero(which));
      some[n] = rays[places[n]];
      ++n;
    }
    probe.select(places[0]);
    answer_all<Query>(bricks, scene, {some.data(), n}, std::span(theirs.data(), n), probe);
    for (std::size_t i = 0; i < n; ++i) answers[places[i]] = theirs[i];
  }
}

/// Packets of fewer rays are not worth their set-up.
constexpr int fewest_in_packet = 4;

/// Answers packet_size rays, or fewer; those that go the same way, together.
template <class Query, class Queries, class Answer, class Probe>
HWY_INLINE void answer_packet(const Bricks& bricks, const Scene& scene, std::span<const Ray> rays,
                              std::span<Answer> answers, PacketSharing& sharing, Probe& probe) {
  std::array<Ray, packet_size> padded;
  const Ray* group = rays.data();
  if (rays.size() < packet_size) {
    std::ranges::copy(rays, padded.begin());
    group = padded.data();
  }
  PacketMask others = (PacketMask{1} << rays.size()) - 1;
  RayPacket packet;
  const PacketMask taken = packet.load(group, bricks.grid) & others;
  if (std::popcount(taken) >= fewest_in_packet) {
    PacketFrustum frustum;
    const PacketMask live = frustum.bound(packet, bricks.grid, taken), same = frustum.same();
    if (std::popcount(same) >= fewest_in_packet) {
      others &= ~same;
      Queries queries(scene, group, packet, live, probe);
      if (live != 0) {
        PacketWalk walk(bricks, packet, frustum, queries, probe);
        walk.walk_grid();
        sharing.learn(walk.leaves(), walk.rays_in_leaves());
      }
      queries.finish();
      for_each_ray(same, [&](std::size_t ray) { answers[ray] = queries.answer(ray); });
    }
  }
  if (others != 0) answer_others<Query>(bricks, scene, group, others, answers.data(), probe);
}

template <class Query, class Queries, class Answer, class Probe>
HWY_INLINE void answer_batch(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                             std::span<Answer> all_answers, [[maybe_unused]] std::span<RayCounters> counters,
                             Probe& probe) {
  const FlushDenormals mode;
  PacketSharing sharing;
  for (std::size_t i = 0; i < batch.rays.size(); i += packet_size) {
    const std::size_t n = std::min(packet_size, batch.rays.size() - i);
    const auto rays = batch.rays.subspan(i, n);
    const auto answers = all_answers.subspan(i, n);
    if constexpr (std::is_same_v<Probe, CountingProbe>) probe.begin_rays(counters.subspan(i, n));
    if (use == PacketUse::always || (use == PacketUse::where_worth_while && sharing.worth_while())) {
      answer_packet<Query, Queries>(bricks, scene, rays, answers, sharing, probe);
      continue;
    }
    for (std::size_t j = 0; j < n; j += at_once<Probe>) {
      const std::size_t some = std::min(at_once<Probe>, n - j);
      probe.select(j);
      answer_all<Query>(bricks, scene, rays.subspan(j, some), answers.subspan(j, some), probe);
    }
  }
}

void trace_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                   std::span<Hit> hits) {
  NoProbe probe;
  answer_batch<ClosestHit<NoProbe>, ClosestHits<NoProbe>>(bricks, scene, batch, use, hits, {}, probe);
}
void trace_any(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
               std::span<std::uint8_t> occluded) {
  NoProbe probe;
  answer_batch<AnyHit<NoProbe>, AnyHits<NoProbe>>(bricks, scene, batch, use, occluded, {}, probe);
}
void count_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                   std::span<Hit> hits, std::span<RayCounters> counters) {
  using Probe = CountingProbe;
  Probe probe(scene.primitive_count());
  answer_batch<ClosestHit<Probe>, ClosestHits<Probe>>(bricks, scene, batch, use, hits, counters, probe);
}
void count_any(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
               std::span<std::uint8_t> occluded, std::span<RayCounters> counters) {
  using Probe = CountingProbe;
  Probe probe(scene.primitive_count());
  answer_batch<AnyHit<Probe>, AnyHits<Probe>>(bricks, scene, batch, use, occluded, counters, probe);
}

}  // namespace

const BrickKernels& target_kernels() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse4.2";
  static constexpr BrickKernels kernels{isa, trace_closest, trace_any, count_closest, count_any};
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
