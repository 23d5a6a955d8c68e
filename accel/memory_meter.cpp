#include "accel/memory_meter.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <cstddef>
#include <memory>
#include <new>

namespace raymeter {

void MemoryMeter::add(std::uint64_t bytes) {
  const std::uint64_t now = bytes_ += bytes;
  if (now > limit_) {
    bytes_ -= bytes;
    throw MemoryLimitExceeded(fmt::format("needs {:.3g} MB or more where {:.3g} MB are allowed",
                                          double(now) / 1e6, double(limit_) / 1e6));
  }
  std::uint64_t peak = peak_;
  while (now > peak && !peak_.compare_exchange_weak(peak, now)) {
  }
}

namespace {

constexpr std::align_val_t line{cache_line};

constexpr std::size_t page = 4096;

void prefer_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t huge = 2 << 20;
  if (bytes >= 2 * huge && std::align(page, page, memory, bytes) != nullptr)
    madvise(memory, bytes / page * page, MADV_HUGEPAGE);  // it may refuse
#endif
}

}  // namespace

void* allocate_lines(std::size_t bytes) {
  void* const memory = ::operator new(bytes, line);
  prefer_huge_pages(memory, bytes);
  return memory;
}
void free_lines(void* memory) noexcept {
  ::operator delete(memory, line);
}

void* map_pages([[maybe_unused]] std::size_t bytes) {
#ifdef MAP_NORESERVE
  void* const memory =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  prefer_huge_pages(memory, bytes);
  return memory;
#else
  return nullptr;
#endif
}
void unmap_pages(void* memory, std::size_t kept, std::size_t bytes) noexcept {
  kept = (kept + page - 1) / page * page;
  if (kept < bytes) munmap(static_cast<std::byte*>(memory) + kept, bytes - kept);
}

}  // namespace raymeter
