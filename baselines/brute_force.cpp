#include "baselines/brute_force.h"

#include <algorithm>
#include <vector>

#include "accel/per_ray_structure.h"
#include "accel/primitive_test.h"

namespace raymeter {
namespace {

class BruteForce final : public PerRayStructure<BruteForce> {
 public:
  explicit BruteForce(const Scene& scene) : PerRayStructure(scene) {}

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit best;
    if (!is_traceable(ray)) return best;
    const FilterRay filter(ray);
    for (std::uint32_t primitive = 0; primitive < scene().primitive_count(); ++primitive)
      test_closest(scene(), primitive, filter, best, probe);
    return best;
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    if (!is_traceable(ray)) return false;
    const FilterRay filter(ray);
    for (std::uint32_t primitive = 0; primitive < scene().primitive_count(); ++primitive)
      if (test_any(scene(), primitive, filter, probe)) return true;
    return false;
  }

  // The same tests in blocks of rays and primitives, so that a scene larger than the cache is read once for
  // each block of rays and not once for each ray.
  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    const FlushDenormals mode;
    std::fill(hits.begin(), hits.end(), Hit{});
    NoProbe probe;
    trace_blocks(batch.rays, [&](std::size_t ray, const FilterRay& filter, std::uint32_t primitive) {
      test_closest(scene(), primitive, filter, hits[ray], probe);
      return false;
    });
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    const FlushDenormals mode;
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    NoProbe probe;
    trace_blocks(batch.rays, [&](std::size_t ray, const FilterRay& filter, std::uint32_t primitive) {
      occluded[ray] = test_any(scene(), primitive, filter, probe);
      return occluded[ray] != 0;
    });
  }

  StructureStats stats() const override {
    StructureStats stats;
    stats.references = scene().primitive_count();
    return stats;
  }

 private:
  static constexpr std::size_t rays_per_block = 256;
  static constexpr std::uint32_t primitives_per_block = 512;

  /// Calls test(index of ray, its FilterRay, primitive) for every pair, primitives of a ray in ascending
  /// order, until it returns true for the ray.
  template <class Test>
  void trace_blocks(std::span<const Ray> rays, const Test& test) const {
    struct PendingRay {
      std::size_t index;
      FilterRay filter;
    };
    std::vector<PendingRay> pending;
    const auto primitives = static_cast<std::uint32_t>(scene().primitive_count());
    for (std::size_t first_ray = 0; first_ray < rays.size(); first_ray += rays_per_block) {
      pending.clear();
      for (std::size_t i = first_ray; i < std::min(rays.size(), first_ray + rays_per_block); ++i)
        if (is_traceable(rays[i])) pending.push_back({i, FilterRay(rays[i])});
      for (std::uint32_t first = 0; first < primitives; first += primitives_per_block) {
        const std::uint32_t end = first + std::min(primitives_per_block, primitives - first);
        std::erase_if(pending, [&](const PendingRay& ray) {
          for (std::uint32_t primitive = first; primitive < end; ++primitive)
            if (test(ray.index, ray.filter, primitive)) return true;
          return false;
        });
      }
    }
  }
};

}  // namespace

StructureKind brute_force_kind() {
  return {
      "brute-force",
      "every primitive, every ray: the truth",
      "the definition of a hit (scenes/geometry/decide.h)",
      Answers::exact,
      {},
      [](const Arguments&, const BuildInput& input) { return std::make_unique<BruteForce>(input.scene); }};
}

}  // namespace raymeter
