#pragma once
#include <optional>

#include "scenes/geometry/ray.h"
#include "scenes/scene.h"

namespace raymeter {

/// A point just off a surface, and the unit normal toward the side on which it lies.
struct SurfaceStart {
  Vec3 origin;
  Vec3d normal;
};

/// Where rays start that leave the surface which `ray` hit, on the side that `ray` came from. Nothing for a
/// miss, where the surface has no normal (a cone's tip), and where the point would be beyond the range of
/// float: such hits have no secondary rays.
///
/// The offset is error-bounded (after Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed. 2023,
/// 6.8.6), and so much smaller than any that is a fixed part of the scene. With p = o + t d and u = 2^-24:
///   - t is the exact root, rounded (decide.h): it moves p along axis i by at most u |t d_i|;
///   - o + t d in double adds 2^-53 |p_i| at most, for t d_i is exact (24 + 24 bits);
///   - rounding the shifted point to float adds u |p_i|, flushing denormals FLT_MIN.
/// Off the plane these make at most  e = sum of |n_i| (u |t d_i| + u |p_i| + FLT_MIN),  n being the unit
/// normal. The point is shifted by 4 e along n: one e to lie on the right side of a triangle's plane for
/// certain, the others for the rounding of n, for the bend of a quadric, and so that kernels in float, which
/// other tracers have, agree about the side.
///
/// What the offset can't and needn't prevent: where two surfaces meet at an edge that is concave, a ray may
/// start within 4 e of the other one, or behind it, and hit it at a tiny t or miss it; so where the inside of
/// a quadric is narrower than that. That is the answer to this ray, the same for every structure.
std::optional<SurfaceStart> leave_surface(const Scene& scene, const Ray& ray, const Hit& hit);

/// The same for rays that go through the surface: the point lies on the other side, as far off it; the normal
/// is leave_surface's, and so points away from it.
std::optional<SurfaceStart> enter_surface(const Scene& scene, const Ray& ray, const Hit& hit);

/// Denormals and -0 become +0.
Vec3 flushed(Vec3 v);

}  // namespace raymeter
