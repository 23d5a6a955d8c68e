#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

namespace raymeter {

/// A 64-bit content hash (XXH3), fed in pieces. Equal content gives equal hashes on every machine:
/// feed it numbers, never structs with padding or pointers.
class Hasher {
 public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  void bytes(const void* data, std::size_t size);

  template <class T>
  void value(const T& number) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes(&number, sizeof number);
  }
  /// An array of a padding-free type.
  template <class T>
  void array(std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(static_cast<std::uint64_t>(items.size()));
    bytes(items.data(), items.size_bytes());
  }
  void text(std::string_view string) { array(std::span<const char>(string.data(), string.size())); }

  std::uint64_t digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace raymeter
