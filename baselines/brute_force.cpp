#include "baselines/brute_force.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "accel/per_ray_structure.h"
#include "accel/primitive_test.h"

namespace raymeter {
namespace {

/// Triangles laid out so that the compiler tests several at once.
struct TriangleBlock {
  static constexpr std::uint32_t size = 256;
  std::array<std::array<float, size>, 9> values;  // a, b - a, c - a
  std::array<std::int32_t, size> outside;

  void load(const Scene& scene, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Triangle triangle = scene.triangle(first + i);
      const Vec3 e1 = triangle.b - triangle.a, e2 = triangle.c - triangle.a;
      for (int axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<std::size_t>(axis);
        values[row][i] = triangle.a[axis];
        values[3 + row][i] = e1[axis];
        values[6 + row][i] = e2[axis];
      }
    }
  }
  void filter(const FilterRay& ray, std::uint32_t count) {
    const Vec3 d = ray.direction, o = ray.ray.origin;
    const auto& [ax, ay, az, ex, ey, ez, fx, fy, fz] = values;
    for (std::uint32_t i = 0; i < count; ++i)
      outside[i] = filter::passes_outside(d, {o.x - ax[i], o.y - ay[i], o.z - az[i]}, {ex[i], ey[i], ez[i]},
                                          {fx[i], fy[i], fz[i]});
  }
};

/// Calls test(index of ray, its FilterRay, primitive) for every pair that is not certainly a miss, primitives
/// of a ray in ascending order, until it returns true for the ray. A block of primitives stays in the cache
/// while all rays are tested against it.
template <class Test>
void for_pairs(const Scene& scene, std::span<const Ray> rays, const Test& test) {
  struct PendingRay {
    std::size_t index;
    FilterRay filter;
  };
  std::vector<PendingRay> pending;
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (is_traceable(rays[i])) pending.push_back({i, FilterRay(rays[i])});

  const auto block = std::make_unique<TriangleBlock>();
  const auto triangles = static_cast<std::uint32_t>(scene.triangle_count());
  for (std::uint32_t first = 0; first < triangles; first += TriangleBlock::size) {
    const std::uint32_t count = std::min(TriangleBlock::size, triangles - first);
    block->load(scene, first, count);
    std::erase_if(pending, [&](const PendingRay& ray) {
      block->filter(ray.filter, count);
      for (std::uint32_t i = 0; i < count; ++i)
        if (!block->outside[i] && test(ray.index, ray.filter, first + i)) return true;
      return false;
    });
  }
  const auto primitives = static_cast<std::uint32_t>(scene.primitive_count());
  for (const PendingRay& ray : pending)
    for (std::uint32_t quadric = triangles; quadric < primitives; ++quadric)
      if (test(ray.index, ray.filter, quadric)) break;
}

class BruteForce final : public PerRayStructure<BruteForce> {
 public:
  explicit BruteForce(const Scene& scene) : PerRayStructure(scene) {}

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return is_traceable(ray) ? closest_of_all(scene(), ray, probe) : Hit{};
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return is_traceable(ray) && any_of_all(scene(), ray, probe);
  }

  // The same answers: triangles filtered in blocks, about three times as fast.
  void trace_closest(const BatchView& batch, std::span<Hit> hits) const override {
    const FlushDenormals mode;
    std::fill(hits.begin(), hits.end(), Hit{});
    NoProbe probe;
    for_pairs(scene(), batch.rays, [&](std::size_t ray, const FilterRay& filter, std::uint32_t primitive) {
      test_closest(scene(), primitive, filter, hits[ray], probe);
      return false;
    });
  }
  void trace_any(const BatchView& batch, std::span<std::uint8_t> occluded) const override {
    const FlushDenormals mode;
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    NoProbe probe;
    for_pairs(scene(), batch.rays, [&](std::size_t ray, const FilterRay& filter, std::uint32_t primitive) {
      occluded[ray] = test_any(scene(), primitive, filter, probe);
      return occluded[ray] != 0;
    });
  }

  StructureStats stats() const override {
    StructureStats stats;
    stats.references = scene().primitive_count();
    return stats;
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
