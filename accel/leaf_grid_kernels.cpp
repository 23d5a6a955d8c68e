#include "accel/leaf_grid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/leaf_grid_kernels.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <bit>
#include <span>

#include "accel/answer_rays-inl.h"

#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

/// The Tracer of answer_rays: each cell is a leaf.
struct LeafGridTracer {
  static_assert(BrickWalk::no_root == LeafGrid::empty_cell);
  const LeafGrid& grid;

  HWY_INLINE BrickWalk walk(const RayPacket& packet, std::size_t v, std::uint64_t which) const {
    return {grid.grid, grid.leaves.data(), nullptr, packet, v, which};
  }
  template <class Probe, class Visit>
  HWY_INLINE void visit_roots(const BrickWalk& walk, const RayPacket& packet, std::size_t v,
                              std::uint64_t found, Probe& probe, const Visit& visit) const {
    for (std::uint64_t rest = found; rest != 0; rest &= rest - 1)
      __builtin_prefetch(&grid.words[walk.root(static_cast<std::size_t>(std::countr_zero(rest)))]);
    for (std::uint64_t rest = found; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      const std::uint32_t* const header = grid.words.data() + walk.root(lane);
      if (header[0] == LeafGrid::subgrid) {
        probe.inner_step();
        probe.enter_subgrid();
        visit_subgrid(grid.subgrids[header[1]], packet, v, lane, probe, visit);
      } else {
        probe.cell_step(false);
        visit(leaf_of(header, walk.reach(lane)), v * lanes + lane);
      }
    }
  }

 private:
  /// Walks a ray through the grid of the cell that it is in.
  template <class Probe, class Visit>
  HWY_NOINLINE void visit_subgrid(const LeafGrid::SubGrid& sub, const RayPacket& packet, std::size_t v,
                                  std::size_t lane, Probe& probe, const Visit& visit) const {
    const std::size_t ray = v * lanes + lane;
    BrickWalk walk(sub.grid, grid.leaves.data() + sub.first_cell, nullptr, packet, v,
                   std::uint64_t{1} << lane);
    while (walk.next_roots(probe) != 0) {
      probe.cell_step(false);
      if (visit(leaf_of(grid.words.data() + walk.root(lane), walk.reach(lane)), ray)) return;
      walk.end(lane, packet.after[ray]);
    }
  }

  HWY_INLINE static Leaf leaf_of(const std::uint32_t* header, float reach) {
    const std::uint32_t triangles = header[0], others = header[1];
    const std::uint32_t* const words = header + LeafGrid::header;
    return {words, triangles, {words + LeafWords::count(triangles), others}, reach, 1};
  }
};

template <class Queries, class Answer, class Probe>
void answer(const LeafGrid& grid, const Scene& scene, const BatchView& batch, std::span<Answer> answers,
            std::span<RayCounters> counters, Probe& probe) {
  answer_batch<Queries>(LeafGridTracer{grid}, grid.grid, grid.space, scene, batch, answers, counters, probe,
                        [](const RayPacket&, PacketMask, Queries&) { return PacketMask{0}; });
}

template <template <class> class Queries, class Answer>
void trace(const LeafGrid& grid, const Scene& scene, const BatchView& batch, std::span<Answer> answers) {
  NoProbe probe;
  answer<Queries<NoProbe>>(grid, scene, batch, answers, {}, probe);
}
template <template <class> class Queries, class Answer>
void count(const LeafGrid& grid, const Scene& scene, const BatchView& batch, std::span<Answer> answers,
           std::span<RayCounters> counters) {
  CountingProbe probe(scene.primitive_count());
  answer<Queries<CountingProbe>>(grid, scene, batch, answers, counters, probe);
}

}  // namespace

const LeafGridKernels& leaf_grid_target_kernels() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse4.2";
  static constexpr LeafGridKernels kernels{isa, trace<ClosestHits, Hit>, trace<AnyHits, std::uint8_t>,
                                           count<ClosestHits, Hit>, count<AnyHits, std::uint8_t>};
  return kernels;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace raymeter {

std::vector<const LeafGridKernels*> leaf_grid_kernels() {
  std::vector<const LeafGridKernels*> kernels;
#if HWY_ARCH_X86
  const auto supported = hwy::SupportedTargets();
  if (supported & HWY_AVX3) kernels.push_back(&N_AVX3::leaf_grid_target_kernels());
  if (supported & HWY_AVX2) kernels.push_back(&N_AVX2::leaf_grid_target_kernels());
  if (supported & HWY_SSE4) kernels.push_back(&N_SSE4::leaf_grid_target_kernels());
#endif
  return kernels;
}

}  // namespace raymeter
#endif
