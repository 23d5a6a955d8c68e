#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "accel/memory_meter.h"
#include "baselines/embree_api.h"
#include "scenes/scene.h"

namespace raymeter {

/// An Embree device of one structure's own, so that the memory it reports to the meter is that structure's.
///
/// Embree's number of threads belongs to the process: it builds with the largest that any living device
/// asked for. Only structures built for the same number should be alive together.
class EmbreeDevice {
 public:
  /// `isa` is default, sse2, sse4.2, avx, avx2 or avx512: the newest instruction set that Embree may use.
  /// Throws Error when this CPU does not have it (Embree itself would not notice).
  /// The meter must outlive the device.
  EmbreeDevice(unsigned threads, std::string_view isa, MemoryMeter& memory);
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice handle() const { return device_.get(); }

  /// To be called after calls into Embree, on the same thread. Throws MemoryLimitExceeded if Embree was
  /// refused memory, or std::runtime_error with Embree's words if a call failed.
  void check() const;

 private:
  static void note_error(void* self, RTCError code, const char* text);
  static bool note_memory(void* self, ssize_t bytes, bool post);

  mutable std::mutex mutex_;  // guards the texts
  std::string error_, refusal_;
  MemoryMeter& memory_;
  template <auto release>
  struct Release {
    template <class T>
    void operator()(T* handle) const {
      release(handle);
    }
  };
  std::unique_ptr<RTCDeviceTy, Release<rtcReleaseDevice>> device_;

 public:
  using SceneHandle = std::unique_ptr<RTCSceneTy, Release<rtcReleaseScene>>;
  using GeometryHandle = std::unique_ptr<RTCGeometryTy, Release<rtcReleaseGeometry>>;
  using BvhHandle = std::unique_ptr<RTCBVHTy, Release<rtcReleaseBVH>>;
};

/// Whether all of a box is within `embree_largest_coordinate`. Embree drops primitives that are not without a
/// word.
bool embree_accepts(const Bounds& box);

/// The instruction set that `isa=default` comes to on this machine, in the words of that parameter.
std::string_view embree_default_isa();

}  // namespace raymeter
