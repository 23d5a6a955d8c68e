#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "scenes/base/error.h"

namespace raymeter {

/// The number whose bytes begin at `from`, aligned or not.
template <class T>
T load(const char* from, std::endian order) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), from, sizeof(T));
  if (order != std::endian::native) std::ranges::reverse(raw);
  return std::bit_cast<T>(raw);
}

/// Reads numbers from the bytes of a file, never beyond their end.
class ByteCursor {
 public:
  /// `file` is for messages; `bytes` must outlive the cursor.
  ByteCursor(std::string file, std::string_view bytes, std::endian order, std::size_t offset)
      : file_(std::move(file)), bytes_(bytes), order_(order), position_(std::min(offset, bytes.size())) {}

  std::size_t offset() const { return position_; }
  std::size_t bytes_left() const { return bytes_.size() - position_; }

  template <class T>
  T read() {
    if (bytes_left() < sizeof(T)) fail("the file ends here, in the middle of its data");
    const T value = load<T>(bytes_.data() + position_, order_);
    position_ += sizeof(T);
    return value;
  }
  /// `count` is at most bytes_left().
  void skip(std::size_t count) { position_ += count; }

  /// Throws an Error that names file and byte.
  [[noreturn]] void fail(std::string_view what) const { fail_at(position_, what); }
  [[noreturn]] void fail_at(std::size_t offset, std::string_view what) const {
    throw error_at_byte(file_, offset, what);
  }

 private:
  std::string file_;
  std::string_view bytes_;
  std::endian order_;
  std::size_t position_;
};

}  // namespace raymeter
