#pragma once
#include "accel/structure.h"
#include "scenes/base/float_mode.h"

namespace raymeter {

/// Makes the four batch functions from an author's two per-ray templates (see Structure). `Derived` has
/// `closest_hit` and `any_hit`; they are compiled twice, with NoProbe for timing and with CountingProbe for
/// counting, so that timed code carries no counter. All four may be overridden, to trace rays of a batch
/// together: then the two that trace and the two that count must do the same work.
template <class Derived>
class PerRayStructure : public Structure {
 public:
  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    const FlushDenormals mode;
    NoProbe probe;
    for (std::size_t i = 0; i < batch.rays.size(); ++i) hits[i] = self().closest_hit(batch.rays[i], probe);
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    const FlushDenormals mode;
    NoProbe probe;
    for (std::size_t i = 0; i < batch.rays.size(); ++i) occluded[i] = self().any_hit(batch.rays[i], probe);
  }
  void count_closest(const BatchView& batch, std::span<Hit> hits,
                     std::span<RayCounters> counters) const override {
    const FlushDenormals mode;
    CountingProbe probe(scene_.primitive_count());
    for (std::size_t i = 0; i < batch.rays.size(); ++i) {
      probe.begin_ray(counters[i]);
      hits[i] = self().closest_hit(batch.rays[i], probe);
    }
  }
  void count_any(const BatchView& batch, std::span<std::uint8_t> occluded,
                 std::span<RayCounters> counters) const override {
    const FlushDenormals mode;
    CountingProbe probe(scene_.primitive_count());
    for (std::size_t i = 0; i < batch.rays.size(); ++i) {
      probe.begin_ray(counters[i]);
      occluded[i] = self().any_hit(batch.rays[i], probe);
    }
  }

 protected:
  /// The scene must outlive the structure.
  explicit PerRayStructure(const Scene& scene) : scene_(scene) {}
  const Scene& scene() const { return scene_; }

 private:
  const Derived& self() const { return static_cast<const Derived&>(*this); }
  const Scene& scene_;
};

}  // namespace raymeter
