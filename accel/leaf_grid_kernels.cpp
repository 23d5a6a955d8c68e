#include "accel/leaf_grid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/leaf_grid_kernels.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <bit>

#include "accel/brick_walk-inl.h"
#include "accel/leaf_queries-inl.h"
#include "scenes/base/float_mode.h"

#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

/// The leaf of the cell that a ray is in.
HWY_INLINE Leaf leaf_of(const LeafGrid& grid, const BrickWalk& walk, std::size_t lane) {
  const std::uint32_t* const header = grid.words.data() + walk.root(lane);
  const std::uint32_t triangles = header[0], others = header[1];
  const std::uint32_t* const words = header + LeafGrid::header;
  return {words, triangles, {words + LeafWords::count(triangles), others}, walk.reach(lane), 1};
}

/// Answers as many rays as there are lanes, or fewer. A probe counts them as if they were one.
template <class Query, class Answer, class Probe>
HWY_INLINE void answer_all(const LeafGrid& grid, const Scene& scene, std::span<const Ray> rays,
                           std::span<Answer> answers, Probe& probe) {
  BrickWalk walk(grid, rays);
  alignas(Query) std::array<std::byte, sizeof(Query) * lanes> storage;
  Query* const queries = reinterpret_cast<Query*>(storage.data());
  for (std::size_t i = 0; i < rays.size(); ++i) new (&queries[i]) Query(scene, walk.ray(i), probe);
  while (const std::uint64_t in = walk.next_roots(probe)) {
    for (std::uint64_t rest = in; rest != 0; rest &= rest - 1)
      __builtin_prefetch(&grid.words[walk.root(static_cast<std::size_t>(std::countr_zero(rest)))]);
    for (std::uint64_t rest = in; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
      probe.cell_step(false);
      queries[lane].visit(leaf_of(grid, walk, lane));
      walk.end(lane, queries[lane].tmax());
    }
  }
  for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = queries[i].answer();
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - rays.size());
  for (std::uint64_t rest = all & ~walk.taken(); rest != 0; rest &= rest - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
    answers[lane] = answer_special<Query, Answer>(grid, scene, rays[lane], probe,
                                                  [&](const BrickWalk& special, auto& query) {
                                                    probe.cell_step(false);
                                                    query.visit(leaf_of(grid, special, 0));
                                                  });
  }
}

template <template <class> class Query, class Answer>
void trace(const LeafGrid& grid, const Scene& scene, const BatchView& batch, std::span<Answer> answers) {
  const FlushDenormals mode;
  NoProbe probe;
  for (std::size_t i = 0; i < batch.rays.size(); i += lanes) {
    const std::size_t n = std::min(lanes, batch.rays.size() - i);
    answer_all<Query<NoProbe>>(grid, scene, batch.rays.subspan(i, n), answers.subspan(i, n), probe);
  }
}
template <template <class> class Query, class Answer>
void count(const LeafGrid& grid, const Scene& scene, const BatchView& batch, std::span<Answer> answers,
           std::span<RayCounters> counters) {
  const FlushDenormals mode;
  CountingProbe probe(scene.primitive_count());
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    probe.begin_ray(counters[i]);
    answer_all<Query<CountingProbe>>(grid, scene, batch.rays.subspan(i, 1), answers.subspan(i, 1), probe);
  }
}

}  // namespace

const LeafGridKernels& leaf_grid_target_kernels() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse4.2";
  static constexpr LeafGridKernels kernels{isa, trace<ClosestHit, Hit>, trace<AnyHit, std::uint8_t>,
                                           count<ClosestHit, Hit>, count<AnyHit, std::uint8_t>};
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
