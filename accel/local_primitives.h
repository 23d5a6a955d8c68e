#pragma once
// Where a build takes triangles from, and how it gathers them for vectors.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "accel/brick_overlap.h"
#include "accel/memory_meter.h"
#include "scenes/scene.h"

namespace raymeter {

/// A scene's primitives, by the scene's numbers.
class ScenePrimitives {
 public:
  explicit ScenePrimitives(const Scene& scene) : indices_(scene.triangles()), vertices_(scene.vertices()) {}

  /// Sets `numbers` to what these primitives have here.
  void add(std::span<const std::uint32_t> primitives, MeteredVector<std::uint32_t>& numbers) {
    numbers.assign(primitives.begin(), primitives.end());
  }
  std::uint32_t primitive(std::uint32_t number) const { return number; }
  Triangle triangle(std::uint32_t number) const {
    const auto& [a, b, c] = indices_[number];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }
  /// Calls use(corner) for those of a triangle.
  template <class Use>
  void for_each_corner(std::uint32_t number, const Use& use) const {
    for (const std::uint32_t corner : indices_[number]) use(vertices_[corner]);
  }

 private:
  std::span<const std::array<std::uint32_t, 3>> indices_;
  std::span<const Vec3> vertices_;
};

/// Some of a scene's primitives, numbered as they come, with the corners of triangles side by side: what may
/// lie anywhere in a large scene is fetched once, and not again for each node and leaf. Embree's builders
/// carry boxes along for that (Wald et al., "Embree: A Kernel Framework for Efficient CPU Ray Tracing",
/// 2014).
class LocalPrimitives {
 public:
  LocalPrimitives(const Scene& scene, MemoryMeter& meter)
      : scene_(&scene),
        primitives_(MeteredAllocator<std::uint32_t>(meter)),
        triangles_(RawMeteredAllocator<Corners>(meter)) {}

  /// Triangles first. Sets `numbers` to what they have here.
  void add(std::span<const std::uint32_t> primitives, MeteredVector<std::uint32_t>& numbers) {
    const std::size_t first = primitives_.size(), count = primitives.size();
    numbers.resize(count);
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(first));
    primitives_.insert(primitives_.end(), primitives.begin(), primitives.end());
    triangles_.resize(first + count);

    // Each is a miss of the cache, or two: many are to be on their way together.
    constexpr std::size_t vertices_ahead = 16, indices_ahead = 48;
    const auto indices = scene_->triangles();
    const auto vertices = scene_->vertices();
    const auto end = std::ranges::partition_point(primitives, [&](auto p) { return scene_->is_triangle(p); });
    const auto triangles = static_cast<std::size_t>(end - primitives.begin());
    const auto indices_of = [&](std::size_t i) { return &indices[primitives[std::min(i, triangles - 1)]]; };
    for (std::size_t i = 0; i < triangles; ++i) {
      __builtin_prefetch(indices_of(i + indices_ahead));
      for (const std::uint32_t corner : *indices_of(i + vertices_ahead))
        __builtin_prefetch(&vertices[corner]);
      triangles_[first + i] = std::bit_cast<Corners>(scene_->triangle(primitives[i]));
    }
  }
  std::uint32_t primitive(std::uint32_t number) const { return primitives_[number]; }
  Triangle triangle(std::uint32_t number) const { return std::bit_cast<Triangle>(triangles_[number]); }
  /// As above.
  template <class Use>
  void for_each_corner(std::uint32_t number, const Use& use) const {
    const Corners& at = triangles_[number];
    for (std::size_t c = 0; c < 9; c += 3) use(Vec3{at[c], at[c + 1], at[c + 2]});
  }

 private:
  using Corners = std::array<float, 9>;

  const Scene* scene_;
  MeteredVector<std::uint32_t> primitives_;
  RawMeteredVector<Corners> triangles_;  // by number; of other primitives, anything
};

/// Room for what GatheredTriangles gathers.
struct GatherBuffer {
  static constexpr std::size_t capacity = 256;
  alignas(64) std::array<float, 9 * capacity> rows{};
};

/// Triangles, gathered in columns, so many at a time as the buffer takes.
template <class Primitives>
class GatheredTriangles {
 public:
  GatheredTriangles(const Primitives& all, std::span<const std::uint32_t> triangles, GatherBuffer& buffer)
      : primitives_(all), triangles_(triangles), buffer_(buffer) {
    if (triangles_.size() <= GatherBuffer::capacity) columns_ = gather(triangles_);
  }

  std::span<const std::uint32_t> all() const { return triangles_; }

  /// Calls use(columns, place of the first among the triangles) until all have been used.
  template <class Use>
  void for_each(const Use& use) const {
    constexpr std::size_t capacity = GatherBuffer::capacity;
    if (triangles_.size() <= capacity) {
      if (!triangles_.empty()) use(columns_, 0);
      return;
    }
    for (std::size_t first = 0; first < triangles_.size(); first += capacity)
      use(gather(triangles_.subspan(first, std::min(capacity, triangles_.size() - first))), first);
  }

 private:
  TriangleColumns gather(std::span<const std::uint32_t> triangles) const {
    const std::size_t stride = (triangles.size() + widest_vector - 1) / widest_vector * widest_vector;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      float* column = buffer_.rows.data() + i;
      primitives_.for_each_corner(triangles[i], [&](const Vec3& corner) {
        for (const float x : {corner.x, corner.y, corner.z}) {
          *column = x;
          column += stride;
        }
      });
    }
    return {buffer_.rows.data(), stride, triangles.size()};
  }

  const Primitives& primitives_;
  std::span<const std::uint32_t> triangles_;
  GatherBuffer& buffer_;
  TriangleColumns columns_;
};

}  // namespace raymeter
