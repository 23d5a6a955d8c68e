#pragma once
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "accel/memory_meter.h"

namespace raymeter {

/// Elements side by side whose number need not be known before the last of them is made: they can grow in
/// address space that was set aside for them, where a page takes memory once it is written. They are left as
/// they are when added, and their memory is charged to a meter, which must outlive them.
template <class T>
class GrowingArray {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= cache_line);

 public:
  explicit GrowingArray(MemoryMeter& meter) : meter_(meter) {}
  GrowingArray(const GrowingArray&) = delete;
  GrowingArray& operator=(const GrowingArray&) = delete;
  ~GrowingArray() {
    release();
    meter_.remove(size_ * sizeof(T));
  }

  /// Of an empty array: up to `n` elements will stay where they are when more are added. Returns false where
  /// the system refuses.
  bool set_aside(std::size_t n) {
    elements_ = static_cast<T*>(map_pages(n * sizeof(T)));
    if (elements_ == nullptr) return false;
    space_ = n;
    is_mapped_ = true;
    return true;
  }

  /// To no fewer than there are. Moves them, where nothing was set aside.
  void grow(std::size_t n) {
    if (n <= space_) {
      meter_.add((n - size_) * sizeof(T));
    } else {
      meter_.add(n * sizeof(T));
      T* to = nullptr;
      try {
        to = static_cast<T*>(allocate_lines(n * sizeof(T)));
      } catch (...) {
        meter_.remove(n * sizeof(T));
        throw;
      }
      if (size_ != 0) std::memcpy(to, elements_, size_ * sizeof(T));
      release();
      meter_.remove(size_ * sizeof(T));
      elements_ = to;
      space_ = n;
      is_mapped_ = false;
    }
    size_ = n;
  }

  /// The address space that is not used.
  void give_back() {
    if (!is_mapped_) return;
    unmap_pages(elements_, size_ * sizeof(T), space_ * sizeof(T));
    space_ = size_;
  }

  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }
  T* data() { return elements_; }
  const T* data() const { return elements_; }
  T& operator[](std::size_t i) { return elements_[i]; }
  const T& operator[](std::size_t i) const { return elements_[i]; }
  const T* begin() const { return elements_; }
  const T* end() const { return elements_ + size_; }

 private:
  void release() {
    if (is_mapped_)
      unmap_pages(elements_, 0, space_ * sizeof(T));
    else
      free_lines(elements_);
  }

  MemoryMeter& meter_;
  T* elements_ = nullptr;
  std::size_t size_ = 0, space_ = 0;
  bool is_mapped_ = false;
};

}  // namespace raymeter
