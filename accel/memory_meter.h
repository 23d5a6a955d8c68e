#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

namespace raymeter {

/// A structure would need more memory than it was allowed. The message says how much and how much is allowed.
class MemoryLimitExceeded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Counts the bytes that a structure holds, their peak, and refuses to exceed a limit. Thread-safe.
class MemoryMeter {
 public:
  explicit MemoryMeter(std::uint64_t limit = std::numeric_limits<std::uint64_t>::max()) : limit_(limit) {}
  MemoryMeter(const MemoryMeter&) = delete;
  MemoryMeter& operator=(const MemoryMeter&) = delete;

  /// Throws MemoryLimitExceeded, having counted nothing, when the limit does not allow it.
  void add(std::uint64_t bytes);
  void remove(std::uint64_t bytes) noexcept { bytes_ -= bytes; }
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t peak() const { return peak_; }
  std::uint64_t limit() const { return limit_; }

 private:
  std::atomic<std::uint64_t> bytes_ = 0, peak_ = 0;
  std::uint64_t limit_;
};

inline constexpr std::size_t cache_line = 64;  ///< bytes

/// Memory that begins with a line of the cache. Where it is large the system is asked for huge pages: fewer
/// pages to fetch and to look up. Embree asks for its memory, too. Throws std::bad_alloc.
void* allocate_lines(std::size_t bytes);
/// Of that; null is nothing.
void free_lines(void* memory) noexcept;

/// Address space, of which a page takes memory once it is written: huge pages, as above. Null where the
/// system refuses.
void* map_pages(std::size_t bytes);
/// Gives back what lies beyond the first `kept` bytes of it, but for the rest of a page.
void unmap_pages(void* memory, std::size_t kept, std::size_t bytes) noexcept;

/// Lets a standard container charge its memory to a meter, which must outlive it.
template <class T>
class MeteredAllocator {
 public:
  using value_type = T;
  static_assert(alignof(T) <= cache_line);
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  explicit MeteredAllocator(MemoryMeter& meter) : meter_(&meter) {}
  template <class U>
  MeteredAllocator(const MeteredAllocator<U>& other) : meter_(other.meter_) {}

  T* allocate(std::size_t n) {
    meter_->add(n * sizeof(T));
    try {
      return static_cast<T*>(allocate_lines(n * sizeof(T)));
    } catch (...) {
      meter_->remove(n * sizeof(T));
      throw;
    }
  }
  void deallocate(T* p, std::size_t n) noexcept {
    free_lines(p);
    meter_->remove(n * sizeof(T));
  }
  template <class U>
  friend bool operator==(const MeteredAllocator& a, const MeteredAllocator<U>& b) {
    return a.meter_ == b.meter_;
  }

 private:
  template <class U>
  friend class MeteredAllocator;
  MemoryMeter* meter_;
};

template <class T>
using MeteredVector = std::vector<T, MeteredAllocator<T>>;

/// The same for elements that are all written after resize, which leaves them as they are.
template <class T>
class RawMeteredAllocator : public MeteredAllocator<T> {
 public:
  using MeteredAllocator<T>::MeteredAllocator;
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Arguments>
  void construct(U* p, Arguments&&... arguments) {
    ::new (static_cast<void*>(p)) U(std::forward<Arguments>(arguments)...);
  }
};

template <class T>
using RawMeteredVector = std::vector<T, RawMeteredAllocator<T>>;

}  // namespace raymeter
