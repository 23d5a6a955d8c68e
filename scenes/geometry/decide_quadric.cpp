#include <optional>
#include <span>

#include "scenes/geometry/clipped_roots.h"
#include "scenes/geometry/decide.h"

namespace raymeter {
namespace {

/// A quadric and a ray as the formulas want them, in any arithmetic: everything relative to the base.
template <class Number>
struct QuadricQuery {
  Vector3<Number> origin, direction, axis;
  Number base_radius, widening;  ///< the radius at the base, and how much more it is at the apex
};

/// The points of a ray's line on the quadric; of a sphere all count.
template <class Number>
struct ClippedQuadratic {
  Quadratic<Number> quadratic;
  std::optional<Clip<Number>> clip;

  std::span<const Clip<Number>> clips() const {
    if (!clip) return {};
    return {&*clip, 1};
  }
};

template <class Number>
ClippedQuadratic<Number> on_line(QuadricKind kind, const QuadricQuery<Number>& query) {
  const auto &w = query.origin, &d = query.direction;
  const Number& r = query.base_radius;
  if (kind == QuadricKind::sphere) {
    const auto moment = cross(d, w);
    const Number a = dot(d, d), b = dot(d, w);
    // Lagrange's identity: b^2 - a (w.w - r^2), without its cancellation far from the sphere.
    return {{a, b, dot(w, w) - r * r, a * r * r - dot(moment, moment)}, std::nullopt};
  }
  // At height h = (x . A) the surface has |x x A|^2 = L * radius^2, radius = r + widening * h / L, L = A . A.
  // Multiplied by L it is a polynomial, without a normalised axis.
  const Number l = dot(query.axis, query.axis);
  const auto u = cross(d, query.axis), v = cross(w, query.axis);
  const Number alpha = dot(d, query.axis), beta = dot(w, query.axis);
  const Number slope = query.widening * alpha, radius = l * r + query.widening * beta;
  const Number a = l * dot(u, u) - slope * slope, b = l * dot(u, v) - slope * radius,
               c = l * dot(v, v) - radius * radius;
  return {{a, b, c, b * b - a * c}, Clip<Number>{beta, alpha, Number{}, l}};
}

// The first stage: doubles with running error bounds.

double greatest_component(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The power of two above x, inverted.
double scale_to_one(double x) {
  int exponent = 0;
  std::frexp(x, &exponent);
  return std::ldexp(1.0, -exponent);
}

Vec3d flushed_to_double(const Vec3& v) {
  return {flushed(v.x), flushed(v.y), flushed(v.z)};
}

/// A difference of floats, times a power of two.
Bounded scaled(double difference, double scale) {
  return Bounded::result(difference * scale, 0);
}
Vector3<Bounded> scaled(const Vec3d& difference, double scale) {
  return {scaled(difference.x, scale), scaled(difference.y, scale), scaled(difference.z, scale)};
}

/// The answer, or `undecided`.
float decide_bounded(const Ray& ray, const Quadric& quadric) {
  // Everything is scaled to about 1, so that no product overflows; what underflows Bounded takes care of.
  const Vec3d base = flushed_to_double(quadric.base), d = flushed_to_double(ray.direction);
  const Vec3d w = flushed_to_double(ray.origin) - base, axis = flushed_to_double(quadric.apex) - base;
  const double r = flushed(quadric.base_radius), widening = flushed(quadric.apex_radius) - r;
  const double size = std::max({greatest_component(w), greatest_component(axis), r, std::abs(widening)});
  const double scale = scale_to_one(size), direction_scale = scale_to_one(greatest_component(d));
  const double t_scale = direction_scale / scale;
  const auto on_surface = on_line(
      quadric.kind, QuadricQuery<Bounded>{scaled(w, scale), scaled(d, direction_scale), scaled(axis, scale),
                                          scaled(r, scale), scaled(widening, scale)});
  return least_t(ray, on_surface.quadratic, on_surface.clips(), [&](const Bounded& root) {
    return Bounded{root.value * t_scale, root.error * t_scale + Bounded::tiny};
  });
}

// The second stage: integers.

[[gnu::noinline]] float decide_exactly(const Ray& ray, const Quadric& quadric) {
  ExactUnit unit;
  for (const Vec3& v : {ray.origin, ray.direction, quadric.base, quadric.apex}) unit.admit(v);
  unit.admit(quadric.base_radius);
  unit.admit(quadric.apex_radius);
  const auto base = unit(quadric.base);
  const ExactInteger r = unit(quadric.base_radius);
  const auto on_surface = on_line(
      quadric.kind, QuadricQuery<ExactInteger>{unit(ray.origin) - base, unit(ray.direction),
                                               unit(quadric.apex) - base, r, unit(quadric.apex_radius) - r});
  return least_t(ray, on_surface.quadratic, on_surface.clips());
}

}  // namespace

float decide(const Ray& ray, const Quadric& quadric) {
  if (!is_traceable(ray) || !is_finite(quadric.base) || !is_finite(quadric.apex) ||
      !std::isfinite(quadric.base_radius) || !std::isfinite(quadric.apex_radius))
    return no_hit;
  const float t = decide_bounded(ray, quadric);
  return std::isnan(t) ? decide_exactly(ray, quadric) : t;
}

}  // namespace raymeter
