#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "accel/memory_meter.h"
#include "baselines/embree_api.h"

namespace raymeter {

/// An Embree device of one structure's own, so that the memory it reports is that structure's.
///
/// Embree's number of threads belongs to the process: it builds with the largest that any living device
/// asked for. Only structures built for the same number should be alive together.
class EmbreeDevice {
 public:
  /// `isa` is default, sse2, sse4.2, avx, avx2 or avx512: the newest instruction set that Embree may use.
  /// Throws Error when this CPU does not have it (Embree itself would not notice).
  EmbreeDevice(unsigned threads, std::string_view isa, std::uint64_t memory_limit);
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice handle() const { return device_.get(); }
  const MemoryMeter& memory() const { return memory_; }
  MemoryMeter& memory() { return memory_; }

  /// To be called after calls into Embree, on the same thread. Throws MemoryLimitExceeded, or
  /// std::runtime_error with Embree's words, if one of them failed.
  void check() const;

 private:
  static void note_error(void* self, RTCError code, const char* text);
  static bool note_memory(void* self, ssize_t bytes, bool post);

  mutable std::mutex mutex_;  // guards the texts
  std::string error_, refusal_;
  MemoryMeter memory_;
  template <auto release>
  struct Release {
    template <class T>
    void operator()(T* handle) const {
      release(handle);
    }
  };
  std::unique_ptr<RTCDeviceTy, Release<rtcReleaseDevice>> device_;  // last: it frees into the meter

 public:
  using Scene = std::unique_ptr<RTCSceneTy, Release<rtcReleaseScene>>;
  using Geometry = std::unique_ptr<RTCGeometryTy, Release<rtcReleaseGeometry>>;
  using Bvh = std::unique_ptr<RTCBVHTy, Release<rtcReleaseBVH>>;
};

/// "3.13.5"
std::string embree_version();

/// The instruction set that `isa=default` comes to on this machine, in the words of that parameter.
std::string_view embree_default_isa();

}  // namespace raymeter
