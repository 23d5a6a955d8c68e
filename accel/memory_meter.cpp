#include "accel/memory_meter.h"

#include <fmt/format.h>

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

}  // namespace raymeter
