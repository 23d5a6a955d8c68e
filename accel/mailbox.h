#pragma once
#include <array>
#include <cstdint>

#include "scenes/geometry/ray.h"

namespace raymeter {

/// Which primitives a ray has tested lately, so that one in several cells is mostly tested once. Mailboxes
/// (Amanatides & Woo 1987) live in the primitives; this one lives in the ray, so that threads share nothing:
/// a small table by the lowest bits of the number, which may forget (Shevtsov, Soupikov, Kapustin, "Ray-
/// Triangle Intersection Algorithm for Modern CPU Architectures", 2007).
class Mailbox {
 public:
  Mailbox() { last_.fill(no_primitive); }
  /// Whether it is not known to have been tested; from now on it is.
  bool is_new(std::uint32_t primitive) {
    std::uint32_t& last = last_[primitive % last_.size()];
    if (last == primitive) return false;
    last = primitive;
    return true;
  }

 private:
  std::array<std::uint32_t, 8> last_;
};

/// Remembers nothing.
struct NoMailbox {
  bool is_new(std::uint32_t) { return true; }
};

}  // namespace raymeter
