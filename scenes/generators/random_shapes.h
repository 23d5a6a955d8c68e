#pragma once
// What the families that scatter shapes in the unit cube share.
#include "scenes/base/random.h"
#include "scenes/scene.h"

namespace raymeter {

/// Uniform in the cube low .. high. (Braces keep the order of the draws the same for every compiler.)
inline Vec3 random_point(Random& random, float low, float high) {
  return Vec3{random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

inline void add_triangle(SceneData& data, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(data.vertices.size());
  data.vertices.insert(data.vertices.end(), {a, b, c});
  data.triangles.push_back({first, first + 1, first + 2});
}

/// So near a cube of this middle and side that the cube fills the picture, two of its sides and its top in
/// view.
inline Camera camera_at_cube(const Vec3& middle, float side) {
  return {.from = middle + side * Vec3{0.6f, 0.5f, 1.4f}, .at = middle, .angle = 33};
}

/// Adds a triangle with its corners uniform in the cube centre +- size.
inline void add_random_triangle(SceneData& data, Random& random, const Vec3& centre, float size) {
  const auto first = static_cast<std::uint32_t>(data.vertices.size());
  for (int corner = 0; corner < 3; ++corner)
    data.vertices.push_back(centre + random_point(random, -size, size));
  data.triangles.push_back({first, first + 1, first + 2});
}

}  // namespace raymeter
