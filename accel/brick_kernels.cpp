#include "accel/brick_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/brick_kernels.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <type_traits>

#include "accel/answer_rays-inl.h"
#include "accel/brick_packet-inl.h"

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
  /// One node; false when there is no further one. visit(leaf, ray): whether the ray is done.
  template <class Packet, class Probe, class Visit>
  HWY_INLINE bool step(const Bricks& bricks, const Packet& packet, std::size_t ray, Probe& probe,
                       const Visit& visit) {
    const BrickNode& node = *node_;
    const unsigned octant = packet.octant[ray];
    const std::uint64_t cells = packet.pierced(ray, node);
    if (cells != 0 && node.is_leaf()) {
      probe.cell_step(false);
      if (visit(leaf_of(bricks, node, reach_, cells), ray)) return false;
    } else {
      probe.inner_step();
      if (cells != 0) stack_[depth_++] = {mirrored(cells, octant), &node, packet.after[ray]};
    }
    // The next cell of the innermost brick that has one left; after a hit, only of those before it.
    while (true) {
      if (depth_ == 0) return false;
      Level& level = stack_[depth_ - 1];
      if (level.rest != 0 && level.tmax != packet.after[ray]) {
        level.tmax = packet.after[ray];
        level.rest &= mirrored(packet.pierced(ray, *level.node), octant);
      }
      if (level.rest != 0) break;
      --depth_;
    }
    Level& level = stack_[depth_ - 1];
    const auto cell = static_cast<unsigned>(std::countr_zero(level.rest)) ^ mirror_of[octant];
    level.rest &= level.rest - 1;
    node_ = &bricks.nodes[level.node->child(cell)];
    __builtin_prefetch(node_);
    return true;
  }

 private:
  struct Level {
    std::uint64_t rest;  // cells still to be visited, mirrored into the ray's octant
    const BrickNode* node;
    float tmax;  // for which that was found
  };
  const BrickNode* node_;
  float reach_;
  std::uint32_t depth_;
  Level stack_[deepest_brick + 1];
};

/// The Tracer of answer_rays.
struct BrickTracer {
  static_assert(BrickWalk::no_root == Bricks::empty_cell);
  const Bricks& bricks;

  HWY_INLINE BrickWalk walk(const RayPacket& packet, std::size_t v, std::uint64_t which) const {
    return {bricks.grid, bricks.roots.data(), bricks.root_boxes.data(), packet, v, which};
  }
  /// Nodes of the rays in turn, so that one waits for memory while the others work.
  template <class Packet, class Probe, class Visit>
  HWY_INLINE void visit_roots(const BrickWalk& walk, const Packet& packet, std::size_t v, std::uint64_t found,
                              Probe& probe, const Visit& visit) const {
    std::array<TreeWalk, lanes> trees;
    for (std::uint64_t rest = found; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      trees[lane].begin(&bricks.nodes[walk.root(lane)], walk.reach(lane));
    }
    for (std::uint64_t active = found; active != 0;) {
      for (std::uint64_t rest = active; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        if (!trees[lane].step(bricks, packet, v * lanes + lane, probe, visit))
          active &= ~(std::uint64_t{1} << lane);
      }
    }
  }
};

/// Packets of fewer rays are not worth their set-up.
constexpr int fewest_in_packet = 4;

/// Traces those rays that go the same way, together, if they are enough. Returns them.
template <class Queries, class Probe>
HWY_INLINE PacketMask trace_packet(const Bricks& bricks, const RayPacket& packet, PacketMask taken,
                                   Queries& queries, PacketSharing& sharing, Probe& probe) {
  if (std::popcount(taken) < fewest_in_packet) return 0;
  PacketFrustum frustum;
  const PacketMask live = frustum.bound(packet, bricks.grid, taken), same = frustum.same();
  if (std::popcount(same) < fewest_in_packet) return 0;
  if (live != 0) {
    queries.begin(live);
    PacketWalk walk(bricks, packet, frustum, queries, probe);
    walk.walk_grid();
    sharing.learn(walk.leaves(), walk.rays_in_leaves());
  }
  return same;
}

template <class Queries, class Answer, class Probe>
HWY_INLINE void answer(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                       std::span<Answer> answers, std::span<RayCounters> counters, Probe& probe) {
  PacketSharing sharing;
  answer_batch<Queries>(BrickTracer{bricks}, bricks.grid, bricks.space, scene, batch, answers, counters,
                        probe, [&](const RayPacket& packet, PacketMask taken, Queries& queries) {
                          const bool together =
                              use == PacketUse::always ||
                              (use == PacketUse::where_worth_while && sharing.worth_while());
                          return together ? trace_packet(bricks, packet, taken, queries, sharing, probe) : 0;
                        });
}

void trace_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                   std::span<Hit> hits) {
  NoProbe probe;
  answer<ClosestHits<NoProbe>>(bricks, scene, batch, use, hits, {}, probe);
}
void trace_any(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
               std::span<std::uint8_t> occluded) {
  NoProbe probe;
  answer<AnyHits<NoProbe>>(bricks, scene, batch, use, occluded, {}, probe);
}
void count_closest(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
                   std::span<Hit> hits, std::span<RayCounters> counters) {
  using Probe = CountingProbe;
  Probe probe(scene.primitive_count());
  answer<ClosestHits<Probe>>(bricks, scene, batch, use, hits, counters, probe);
}
void count_any(const Bricks& bricks, const Scene& scene, const BatchView& batch, PacketUse use,
               std::span<std::uint8_t> occluded, std::span<RayCounters> counters) {
  using Probe = CountingProbe;
  Probe probe(scene.primitive_count());
  answer<AnyHits<Probe>>(bricks, scene, batch, use, occluded, counters, probe);
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
