// That the peak memory a structure reports is what its build takes from the system: counted in operator new.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "scenes/open_scene.h"
#include "tests/accel/grid_tests.h"

#if !defined(__SANITIZE_ADDRESS__)
namespace {
std::atomic<std::int64_t> live = 0, most = 0;

void* counted(void* memory) {
  if (!memory) throw std::bad_alloc();
  const std::int64_t now = live += static_cast<std::int64_t>(malloc_usable_size(memory));
  std::int64_t peak = most;
  while (now > peak && !most.compare_exchange_weak(peak, now)) {
  }
  return memory;
}
void release(void* memory) {
  live -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}
}  // namespace

void* operator new(std::size_t size) {
  return counted(std::malloc(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(std::aligned_alloc(
      std::size_t(alignment),
      (size + std::size_t(alignment) - 1) / std::size_t(alignment) * std::size_t(alignment)));
}
void operator delete(void* memory) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  release(memory);
}

namespace raymeter {
namespace {

TEST(PeakMemory, IsWhatTheBuildTakesFromTheSystem) {
  for (const char* name :
       {"soup:triangles=40000", "clusters:objects=40000", "clusters:objects=20000:primitive=cone"}) {
    const Scene scene = open_scene(name);
    for (const char* spec :
         {"grid", "tunable-grid", "octree", "octree:traversal=top-down:leaf=1", "two-level-grid",
          "two-level-grid:threshold=1", "brick-grid", "grid:leaf=simd", "two-level-grid:leaf=simd"}) {
      const std::int64_t before = live;
      most = before;
      const auto structure = build(spec, scene);
      const auto taken = static_cast<double>(most - before), kept = static_cast<double>(live - before);
      const StructureStats stats = structure->stats();
      // The allocator rounds up; names, notes and the object itself are not counted.
      EXPECT_NEAR(static_cast<double>(stats.peak_bytes), taken, 0.02 * taken + 20000) << spec << ' ' << name;
      EXPECT_NEAR(static_cast<double>(stats.bytes), kept, 0.02 * kept + 20000) << spec << ' ' << name;
    }
  }
}

}  // namespace
}  // namespace raymeter
#endif
