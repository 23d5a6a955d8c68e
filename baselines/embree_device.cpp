#include "baselines/embree_device.h"

#include <fmt/format.h>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

/// Embree takes the `isa` it is told on trust and then executes it, so that we must ask the CPU ourselves.
bool cpu_has(std::string_view isa) {
#if defined(__x86_64__)
  if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
  if (isa == "avx") return cpu_has("sse4.2") && __builtin_cpu_supports("avx");
  if (isa == "avx2")
    return cpu_has("avx") && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  if (isa == "avx512")
    return cpu_has("avx2") && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl");
#endif
  return isa == "sse2";
}

}  // namespace

EmbreeDevice::EmbreeDevice(unsigned threads, std::string_view isa, MemoryMeter& memory) : memory_(memory) {
  std::string configuration = fmt::format("threads={}", threads);
  if (isa != "default") {
    if (!cpu_has(isa))
      throw Error(fmt::format("embree: isa={}: this CPU has no more than {}", isa, embree_default_isa()));
    configuration += fmt::format(",isa={}", isa);
  }
  device_.reset(rtcNewDevice(configuration.c_str()));
  if (!device_)
    throw std::runtime_error(fmt::format("embree: no device for '{}' (error {})", configuration,
                                         static_cast<int>(rtcGetDeviceError(nullptr))));
  rtcSetDeviceErrorFunction(handle(), note_error, this);
  rtcSetDeviceMemoryMonitorFunction(handle(), note_memory, this);
}

void EmbreeDevice::note_error(void* self, RTCError, const char* text) {
  auto& device = *static_cast<EmbreeDevice*>(self);
  const std::scoped_lock lock(device.mutex_);
  if (device.error_.empty()) device.error_ = text ? text : "unknown error";
}

bool EmbreeDevice::note_memory(void* self, ssize_t bytes, bool) {
  auto& device = *static_cast<EmbreeDevice*>(self);
  if (bytes <= 0) {
    device.memory_.remove(static_cast<std::uint64_t>(-bytes));
    return true;
  }
  try {
    device.memory_.add(static_cast<std::uint64_t>(bytes));
    return true;
  } catch (const MemoryLimitExceeded& refused) {
    const std::scoped_lock lock(device.mutex_);
    device.refusal_ = refused.what();
    return false;
  }
}

void EmbreeDevice::check() const {
  const RTCError code = rtcGetDeviceError(handle());
  const std::scoped_lock lock(mutex_);
  // A refusal may have happened on another thread, for which Embree keeps another error code.
  if (!refusal_.empty()) throw MemoryLimitExceeded(refusal_);
  if (code != RTC_ERROR_NONE) throw std::runtime_error(fmt::format("embree: {}", error_));
}

bool embree_accepts(const Bounds& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (box.low[axis] < -embree_largest_coordinate || box.high[axis] > embree_largest_coordinate)
      return box.empty();
  return true;
}

std::string_view embree_default_isa() {
  for (const std::string_view isa : {"avx512", "avx2", "avx", "sse4.2"})
    if (cpu_has(isa)) return isa;
  return "sse2";
}

}  // namespace raymeter
