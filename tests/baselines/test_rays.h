#pragma once
// Scenes and rays that the tests of all baselines share.
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "baselines/register_baselines.h"
#include "scenes/base/random.h"
#include "scenes/scene.h"

namespace raymeter {

/// Triangles of all sizes and all three quadrics in [-1, 1]^3, some flat, some coincident.
inline Scene mixed_scene(std::uint64_t seed, std::uint32_t triangles, std::uint32_t quadrics) {
  Random random(seed);
  const auto point = [&](float reach) {
    const float x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
    return Vec3{x, y, random.uniform(-reach, reach)};
  };
  SceneData data;
  data.name = "mixed";
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float size = random.below(8) == 0 ? 0.7f : 0.1f;
    const Vec3 centre = point(1);
    for (int corner = 0; corner < 3; ++corner) {
      Vec3 vertex = centre + point(size);
      // Every fourth triangle lies in a plane of the box, every eighth is moved onto a coarse lattice.
      if (i % 4 == 0) vertex[static_cast<int>(i / 4 % 3)] = centre[static_cast<int>(i / 4 % 3)];
      if (i % 8 == 1)
        for (int axis = 0; axis < 3; ++axis)
          vertex[axis] = static_cast<float>(static_cast<int>(vertex[axis] * 4)) * 0.25f;
      data.vertices.push_back(vertex);
    }
    data.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    if (i % 16 == 5) data.triangles.back() = data.triangles[i - 1];
  }
  for (std::uint32_t i = 0; i < quadrics; ++i) {
    Quadric quadric;
    quadric.kind = static_cast<QuadricKind>(i % 3);
    quadric.base = point(1);
    quadric.base_radius = random.uniform(0.02f, 0.3f);
    if (quadric.kind != QuadricKind::sphere) {
      quadric.apex = quadric.base + point(0.4f);
      quadric.apex_radius =
          quadric.kind == QuadricKind::cylinder ? quadric.base_radius : random.uniform(0.0f, 0.2f);
    }
    data.quadrics.push_back(quadric);
  }
  return Scene(std::move(data));
}

/// A bumpy height field of 2 * n * n triangles over [-1, 1]^2, with shared vertices.
inline Scene terrain_scene(std::uint64_t seed, std::uint32_t n) {
  Random random(seed);
  SceneData data;
  data.name = "terrain";
  for (std::uint32_t y = 0; y <= n; ++y)
    for (std::uint32_t x = 0; x <= n; ++x)
      data.vertices.push_back({2 * static_cast<float>(x) / static_cast<float>(n) - 1,
                               2 * static_cast<float>(y) / static_cast<float>(n) - 1,
                               random.uniform(0, 0.1f)});
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x;
      data.triangles.push_back({v, v + 1, v + n + 1});
      data.triangles.push_back({v + 1, v + n + 2, v + n + 1});
    }
  return Scene(std::move(data));
}

/// Rays from around and inside [-1, 1]^3 in all directions.
inline std::vector<Ray> random_rays(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    for (int axis = 0; axis < 3; ++axis) ray.origin[axis] = random.uniform(-2, 2);
    for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = random.uniform(-1, 1) - ray.origin[axis];
  }
  return rays;
}

/// Rays that a traversal may stumble over: along axes with 0 and -0, through vertices and edges, on the
/// planes of boxes, from inside and from very far, with intervals of every kind, and not traceable ones.
inline std::vector<Ray> adversarial_rays(std::uint64_t seed, std::size_t count, const Scene& scene) {
  Random random(seed);
  std::vector<Ray> rays = random_rays(seed + 1, count);
  const auto some_vertex = [&] {
    const auto vertices = scene.vertices();
    if (vertices.empty()) return Vec3{};
    return vertices[random.below(static_cast<std::uint32_t>(vertices.size()))];
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (Ray& ray : rays) {
    switch (random.below(8)) {
      case 0:  // at a vertex, exactly where the subtraction is exact
        ray.direction = some_vertex() - ray.origin;
        break;
      case 1: {  // at the middle of an edge or of nothing
        const Vec3 a = some_vertex(), b = some_vertex();
        ray.direction = 0.5f * (a + b) - ray.origin;
        break;
      }
      case 2:    // along an axis or a diagonal, on the planes of a vertex
      case 3: {  // the same from inside
        constexpr float components[] = {-1, -0.0f, 0.0f, 1};
        for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = components[random.below(4)];
        const Vec3 through = some_vertex();
        const float back = random.below(2) == 0 ? 4.0f : 0.0f;
        ray.origin = through - back * ray.direction;
        break;
      }
      case 4: {  // from far away
        const float far = random.below(2) == 0 ? 1e5f : 1e12f;
        const Vec3 direction = ray.direction;
        ray.origin = some_vertex() - far * direction;
        break;
      }
      case 5:  // at a corner of the scene's box
        for (int axis = 0; axis < 3; ++axis)
          ray.direction[axis] =
              (random.below(2) == 0 ? scene.bounds().low[axis] : scene.bounds().high[axis]) -
              ray.origin[axis];
        break;
      case 6:  // from a vertex
        ray.origin = some_vertex();
        break;
      default:
        break;
    }
    switch (random.below(10)) {
      case 0:
        ray.tfar = random.uniform(0, 2);
        break;
      case 1:
        ray.tnear = random.uniform(0, 2);
        break;
      case 2:
        ray.tnear = random.uniform(-3, 1);
        ray.tfar = random.uniform(-1, 3);
        break;
      case 3:
        ray.tnear = -infinity;
        break;
      case 4: {
        float* const parts[] = {&ray.origin.x, &ray.direction.y, &ray.tnear, &ray.tfar};
        constexpr float values[] = {nan, infinity, -infinity, 0};
        *parts[random.below(4)] = values[random.below(4)];
        break;
      }
      case 5:
        if (random.below(4) == 0) ray.direction = {};
        break;
      case 6:
        ray.direction = (random.below(2) == 0 ? 1e-18f : 1e18f) * ray.direction;
        break;
      default:
        break;
    }
  }
  return rays;
}

inline std::unique_ptr<Structure> build(std::string_view spec, const Scene& scene) {
  Registry registry;
  register_baselines(registry);
  return registry.build(parse_spec(spec), {scene});
}

inline std::vector<Hit> closest(const Structure& structure, std::span<const Ray> rays) {
  std::vector<Hit> hits(rays.size());
  structure.trace_closest({rays}, hits);
  return hits;
}

inline std::vector<std::uint8_t> any(const Structure& structure, std::span<const Ray> rays) {
  std::vector<std::uint8_t> occluded(rays.size());
  structure.trace_any({rays, QueryKind::any}, occluded);
  return occluded;
}

}  // namespace raymeter
