#pragma once
// Numbers, points and rays that numerical code gets wrong.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <iterator>
#include <utility>

#include "scenes/base/random.h"
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/ray.h"

namespace raymeter::adversary {

/// The ways in which numbers are drawn, from natural to vicious.
enum class Style { natural, halves, small_integers, far_away, mixed_scales, extremes };
inline constexpr Style styles[] = {Style::natural,  Style::halves,       Style::small_integers,
                                   Style::far_away, Style::mixed_scales, Style::extremes};

inline float number(Random& random, Style style) {
  static constexpr float odd_ones[] = {0.0f,   -0.0f,   1.0f,    -1.0f,    FLT_MAX,     -FLT_MAX, FLT_MIN,
                                       1e-40f, -1e-45f, 3e38f,   1.5e-38f, 16777216.0f, 0.1f,     -FLT_MIN,
                                       1e30f,  -1e-30f, 0x1p63f, 0x1p-63f, 1.0000001f,  2e19f,    -3e-20f};
  switch (style) {
    case Style::natural:
      return random.uniform(-1, 1);
    case Style::halves:
      return float(int(random.below(17)) - 8) / 2;
    case Style::small_integers:
      return float(int(random.below(5)) - 2);
    case Style::far_away:
      return 1e6f + random.uniform(-1, 1);
    case Style::mixed_scales:
      return std::ldexp(random.uniform(-1, 1), int(random.below(200)) - 100);
    case Style::extremes:
      return odd_ones[random.below(std::size(odd_ones))];
  }
  return 0;
}

inline Vec3 point(Random& random, Style style) {
  return {number(random, style), number(random, style), number(random, style)};
}

/// A ray towards `target`, now and then exactly, along an axis, scaled, or from near by.
inline Ray ray_towards(Random& random, Style style, const Vec3& target) {
  Ray ray;
  ray.origin = point(random, style);
  ray.direction = target - ray.origin;
  switch (random.below(6)) {
    case 0:
      break;
    case 1: {  // along an axis, with zeros of either sign, from a point that shares two coordinates
      const int axis = int(random.below(3));
      ray.direction = Vec3{random.below(2) ? 0.0f : -0.0f, random.below(2) ? 0.0f : -0.0f, -0.0f};
      ray.direction[axis] = random.below(2) ? 1.0f : -2.5f;
      const float along = ray.origin[axis];
      ray.origin = target;
      ray.origin[axis] = along;
      break;
    }
    case 2: {  // a power of two longer or shorter
      const float scale = std::ldexp(1.0f, int(random.below(240)) - 120);
      ray.direction = scale * ray.direction;
      break;
    }
    case 3:
      ray.direction = point(random, style);
      break;
    case 4: {  // perpendicular to an axis
      const int axis = int(random.below(3));
      ray.origin[axis] = target[axis];
      ray.direction[axis] = -0.0f;
      break;
    }
    default: {  // one ulp off
      const int axis = int(random.below(3));
      ray.direction[axis] = std::nextafter(ray.direction[axis], random.below(2) ? 1e38f : -1e38f);
      break;
    }
  }
  return ray;
}

/// The weighted mean of the corners, often a corner or the middle of an edge.
inline Vec3 point_on(Random& random, const Triangle& triangle) {
  const Vec3 half_ab = 0.5f * triangle.a + 0.5f * triangle.b;
  switch (random.below(6)) {
    case 0:
      return triangle.a;
    case 1:
      return triangle.c;
    case 2:
      return half_ab;
    case 3:
      return 0.5f * triangle.b + 0.5f * triangle.c;
    default: {
      const float u = random.uniform(-0.2f, 1.2f), v = random.uniform(-0.2f, 1.2f);
      return triangle.a + u * (triangle.b - triangle.a) + v * (triangle.c - triangle.a);
    }
  }
}

/// Now and then degenerate.
inline Triangle triangle(Random& random, Style style) {
  Triangle result{point(random, style), point(random, style), point(random, style)};
  switch (random.below(16)) {
    case 0:
      result.b = result.a;
      break;
    case 1:
      result.c = 0.5f * result.a + 0.5f * result.b;
      break;
    case 2:
      result.c = result.a + 0x1p-20f * (result.b - result.a) + Vec3{0, 1e-7f, 0};
      break;
    default:
      break;
  }
  return result;
}

/// Of any kind; often with a tip, an axis along a coordinate axis, no radius or no length.
inline Quadric quadric(Random& random, Style style) {
  Quadric q;
  q.kind = static_cast<QuadricKind>(random.below(3));
  q.base = point(random, style);
  q.base_radius = std::abs(number(random, style));
  if (q.kind == QuadricKind::sphere) return q;
  q.apex = point(random, style);
  q.apex_radius = q.kind == QuadricKind::cylinder ? q.base_radius : std::abs(number(random, style));
  switch (random.below(8)) {
    case 0:
    case 1:
    case 2: {
      const int axis = int(random.below(3));
      const float along = q.apex[axis];
      q.apex = q.base;
      q.apex[axis] = along;
      break;
    }
    case 3:
      q.apex_radius = 0;
      break;
    case 4:
      q.base_radius = 0;
      break;
    case 5:
      if (random.below(8) == 0) q.apex = q.base;
      break;
    default:
      break;
  }
  if (q.kind == QuadricKind::cylinder) q.apex_radius = q.base_radius;
  return q;
}

/// A ray at the tip, rim, silhouette or along a generator of a quadric, or near one.
inline Ray ray_towards(Random& random, Style style, const Quadric& q) {
  const int axis = int(random.below(3));
  Vec3 out{};
  out[axis] = random.below(2) ? 1.0f : -1.0f;
  const bool sphere = q.kind == QuadricKind::sphere;
  const Vec3 rim = q.base + q.base_radius * out, other = q.apex + q.apex_radius * out;
  switch (random.below(8)) {
    case 0:
      return ray_towards(random, style, q.base);
    case 1:
      return ray_towards(random, style, sphere ? rim : q.apex);
    case 2:
      return ray_towards(random, style, rim);
    case 3:
      return ray_towards(random, style, sphere ? rim : 0.5f * rim + 0.5f * other);
    case 4: {  // in the tangent plane at the rim
      Vec3 along = point(random, style);
      along[axis] = 0;
      return {rim - along, 0, random.below(2) ? along : 2.0f * along};
    }
    case 5: {  // parallel to a generator or to the axis, on it or beside it
      const Vec3 direction = sphere ? out : random.below(2) ? other - rim : q.apex - q.base;
      return {random.below(2) ? rim - direction : point(random, style), 0, direction};
    }
    case 6:
      return {rim, 0, point(random, style)};  // from the surface
    default: {
      const Vec3 near{random.uniform(-1.2f, 1.2f), random.uniform(-1.2f, 1.2f), random.uniform(-1.2f, 1.2f)};
      const float along = sphere ? 0.0f : random.uniform();
      return ray_towards(random, style, q.base + along * (q.apex - q.base) + q.base_radius * near);
    }
  }
}

/// The value of the polynomial of a general quadric, roughly, and its gradient.
inline double value_at(const GeneralQuadric& g, const Vec3d& p) {
  const Vec3d w = p - to_double(g.centre);
  const auto& q = g.coefficients;
  return q[0] * w.x * w.x + q[1] * w.y * w.y + q[2] * w.z * w.z + q[3] * w.x * w.y + q[4] * w.y * w.z +
         q[5] * w.z * w.x + q[6] * w.x + q[7] * w.y + q[8] * w.z + q[9];
}
inline Vec3d gradient_at(const GeneralQuadric& g, const Vec3d& p) {
  const Vec3d w = p - to_double(g.centre);
  const auto& q = g.coefficients;
  return {2.0 * q[0] * w.x + q[3] * w.y + q[5] * w.z + q[6],
          q[3] * w.x + 2.0 * q[1] * w.y + q[4] * w.z + q[7],
          q[5] * w.x + q[4] * w.y + 2.0 * q[2] * w.z + q[8]};
}

/// Any polynomial, or a canonical surface along an axis, now and then turned in a way that keeps numbers
/// simple; in a box that holds it all, cuts it, touches it, is flat, or has nothing to do with it.
inline GeneralQuadric general_quadric(Random& random, Style style) {
  // x^2 y^2 z^2  z  1
  static constexpr float canonical[][5] = {
      {1, 1, 1, 0, -1},  {1, 2, 4, 0, -1},   {1, 1, 0, -1, 0}, {1, 1, -1, 0, -1}, {1, 1, -1, 0, 1},
      {1, 1, -1, 0, 0},  {1, 1, 0, 0, -1},   {1, 0, 0, -1, 0}, {1, -1, 0, -1, 0}, {0, 0, 0, 1, 0},
      {1, -1, 0, 0, 0},  {1, 0, 0, 0, 0},    {1, 0, 0, 0, -1}, {1, 1, 1, 0, 0},   {1, 1, 1, 0, 1},
      {1, -1, 0, 0, -1}, {0.1f, 3, 7, 0, -1}};
  GeneralQuadric g;
  g.centre = point(random, style);
  auto& q = g.coefficients;
  float reach = 1;
  if (random.below(3) == 0) {
    for (float& x : q) x = random.below(4) == 0 ? 0 : number(random, style);
    reach = std::abs(number(random, style));
  } else {
    const auto& form = canonical[random.below(std::size(canonical))];
    const unsigned turn = random.below(3), next = (turn + 1) % 3, last = (turn + 2) % 3;
    const float scale = std::ldexp(random.below(2) ? 1.0f : -1.5f, int(random.below(80)) - 40);
    q[turn] = scale * form[0], q[next] = scale * form[1], q[last] = scale * form[2];
    q[6 + last] = scale * form[3], q[9] = scale * form[4];
    if (random.below(2) == 0) {
      // Along the diagonal of two axes: x and y become (x + y) and (x - y), so that q becomes
      // (q0 + q1) (x^2 + y^2) + 2 (q0 - q1) xy.
      const unsigned i = random.below(3), j = (i + 1) % 3;
      const float sum = q[i] + q[j], difference = q[i] - q[j], add = q[6 + i] + q[6 + j];
      q[6 + j] = q[6 + i] - q[6 + j], q[6 + i] = add;
      q[i] = q[j] = sum, q[3 + i] = 2 * difference;
    }
    // Of any size: lengths times s.
    const float s = std::ldexp(1.0f, int(random.below(40)) - 20);
    if (style != Style::natural && style != Style::halves) {
      for (std::size_t i = 0; i < 6; ++i) q[i] /= s * s;
      for (std::size_t i = 6; i < 9; ++i) q[i] /= s;
      reach = s;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    float below = reach, above = reach;
    switch (random.below(6)) {
      case 0:
        below *= random.uniform(-1, 1), above *= 2;
        break;
      case 1:
        above = 0;
        break;
      case 2:
        below = above = 3 * reach;
        break;
      case 3:
        below = std::abs(number(random, style)), above = std::abs(number(random, style));
        break;
      default:
        break;
    }
    if (random.below(40) == 0) below = -above;
    g.clip.low[axis] = g.centre[axis] - below, g.clip.high[axis] = g.centre[axis] + above;
    if (g.clip.low[axis] > g.clip.high[axis]) std::swap(g.clip.low[axis], g.clip.high[axis]);
  }
  return g;
}

/// A point in the clip box, moved along an axis onto the surface where that is possible.
inline Vec3 point_on(Random& random, const GeneralQuadric& g) {
  Vec3d p;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = g.clip.low[axis], high = g.clip.high[axis];
    const std::uint32_t place = random.below(8);
    p[axis] = place == 0 ? low : place == 1 ? high : low + (high - low) * random.uniform();
  }
  const int axis = int(random.below(3));
  const double a = g.coefficients[static_cast<std::size_t>(axis)], half = 0.5 * gradient_at(g, p)[axis],
               discriminant = half * half - a * value_at(g, p);
  const double root = std::sqrt(std::max(0.0, discriminant)),
               step = a != 0 ? (-half + (random.below(2) ? root : -root)) / a : -value_at(g, p) / (2 * half);
  if (std::isfinite(step)) p[axis] += step;
  return to_float(p);
}

/// A ray at the surface, the cut, the tip or the silhouette of a general quadric, or in it, or near one.
inline Ray ray_towards(Random& random, Style style, const GeneralQuadric& g) {
  const Vec3 target = point_on(random, g);
  const Vec3d normal = gradient_at(g, to_double(target));
  switch (random.below(9)) {
    case 0:
      return ray_towards(random, style, g.centre);
    case 1:  // a corner of the box, or an edge
      return ray_towards(
          random, style,
          Vec3{random.below(2) ? g.clip.low.x : g.clip.high.x, random.below(2) ? g.clip.low.y : g.clip.high.y,
               random.below(2) ? g.clip.low.z : target.z});
    case 2:
    case 3: {  // in the tangent plane
      const double size = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
      const Vec3d along = cross(size > 0 ? (1 / size) * normal : normal, to_double(point(random, style)));
      const Vec3 direction = to_float(along);
      return {random.below(2) ? target - direction : target, 0, direction};
    }
    case 4: {  // along the lines of which many of the canonical surfaces consist
      Vec3 direction{float(int(random.below(3)) - 1), float(int(random.below(3)) - 1),
                     float(int(random.below(3)) - 1)};
      Vec3 start = g.centre;
      start[int(random.below(3))] += random.below(2) ? 1.0f : -1.0f;
      return {random.below(2) ? start - direction : target - direction, 0, direction};
    }
    case 5:
      return {target, 0, point(random, style)};
    default:
      return ray_towards(random, style, target);
  }
}

/// Puts the ends of the interval on or beside the hit at t.
inline void tempt_interval(Random& random, Ray& ray, float t) {
  if (t == no_hit) return;
  switch (random.below(6)) {
    case 0:
      ray.tfar = t;
      break;
    case 1:
      ray.tfar = std::nextafter(t, -FLT_MAX);
      break;
    case 2:
      ray.tnear = t;
      break;
    case 3:
      ray.tnear = std::nextafter(t, -FLT_MAX);
      break;
    default:
      break;
  }
}

/// No component that becomes denormal or infinite when it is scaled by 2^60 or 2^-60.
inline bool bears_scaling(const Ray& ray) {
  for (int axis = 0; axis < 3; ++axis) {
    const float size = std::abs(ray.direction[axis]);
    if (size != 0 && (size < 1e-6f || size > 1e6f)) return false;
  }
  return true;
}

}  // namespace raymeter::adversary
