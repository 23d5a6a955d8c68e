#include <array>
#include <optional>

#include "scenes/geometry/bounded.h"
#include "scenes/geometry/decide.h"
#include "scenes/geometry/exact.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

/// A quadric and a ray as the formulas want them, in any arithmetic: everything relative to the base.
template <class Number>
struct QuadricQuery {
  Vector3<Number> origin, direction, axis;
  Number base_radius, widening;  ///< the radius at the base, and how much more it is at the apex
};

/// The points of a ray's line on a quadric: a t^2 + 2 b t + c = 0, of which those count where every clip has
/// low <= p + t q <= high.
template <class Number>
struct ClippedQuadratic {
  struct Clip {
    Number p, q, low, high;
  };
  Number a, b, c, discriminant;
  std::optional<Clip> clip;
};

template <class Number>
ClippedQuadratic<Number> on_line(QuadricKind kind, const QuadricQuery<Number>& query) {
  const auto &w = query.origin, &d = query.direction;
  const Number& r = query.base_radius;
  if (kind == QuadricKind::sphere) {
    const auto moment = cross(d, w);
    const Number a = dot(d, d), b = dot(d, w);
    // Lagrange's identity: b^2 - a (w.w - r^2), without its cancellation far from the sphere.
    return {a, b, dot(w, w) - r * r, a * r * r - dot(moment, moment), std::nullopt};
  }
  // At height h = (x . A) the surface has |x x A|^2 = L * radius^2, radius = r + widening * h / L, L = A . A.
  // Multiplied by L it is a polynomial, without a normalised axis.
  const Number l = dot(query.axis, query.axis);
  const auto u = cross(d, query.axis), v = cross(w, query.axis);
  const Number alpha = dot(d, query.axis), beta = dot(w, query.axis);
  const Number slope = query.widening * alpha, radius = l * r + query.widening * beta;
  const Number a = l * dot(u, u) - slope * slope, b = l * dot(u, v) - slope * radius,
               c = l * dot(v, v) - radius * radius;
  return {a, b, c, b * b - a * c, typename ClippedQuadratic<Number>::Clip{beta, alpha, Number{}, l}};
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
  const auto [a, b, c, discriminant, clip] = on_line(
      quadric.kind, QuadricQuery<Bounded>{scaled(w, scale), scaled(d, direction_scale), scaled(axis, scale),
                                          scaled(r, scale), scaled(widening, scale)});

  if (discriminant.certainly_negative()) return no_hit;
  if (!discriminant.certainly_positive() || !a.certainly_not_zero()) return undecided;
  // The root without cancellation, and the other by their product c / a.
  const Bounded s = sqrt(discriminant), far = b.value < 0 ? s - b : -(b + s);
  if (!far.certainly_not_zero()) return undecided;
  float best = no_hit;
  for (const Bounded& root : {far / a, c / far}) {
    const float t = within(ray, root.value * t_scale, root.error * t_scale + Bounded::tiny);
    if (t == no_hit) continue;
    if (clip) {
      const Bounded height = clip->p + root * clip->q;
      const Bounded above_low = height - clip->low, below_high = clip->high - height;
      if (above_low.certainly_negative() || below_high.certainly_negative()) continue;
      if (!above_low.certainly_positive() || !below_high.certainly_positive()) return undecided;
    }
    if (std::isnan(t)) return undecided;
    best = std::min(best, t);
  }
  return best;
}

// The second stage: integers.

/// One root of a t^2 + 2 b t + c, known by comparison with fractions.
class ExactRoot {
 public:
  /// a >= 0 and a real root exists; a = 0: the linear equation's, whichever is asked for.
  ExactRoot(const ClippedQuadratic<ExactInteger>& quadratic, bool greater)
      : q_(quadratic), greater_(greater) {}

  /// The sign of the root less h.
  int against(const ExactFraction& h) const {
    const ExactInteger &n = h.numerator, &m = h.denominator;
    if (q_.a.sign() == 0) return -ExactInteger(2 * q_.b * n + q_.c * m).sign() * q_.b.sign();
    const ExactInteger slope = q_.a * n + q_.b * m;
    const int value = ExactInteger((slope + q_.b * m) * n + q_.c * m * m).sign();
    // Between the roots; or outside, on the side that the slope tells; or at one of them, or at both.
    if (value < 0) return greater_ ? 1 : -1;
    if (value > 0) return -slope.sign();
    return slope.sign() == 0 || (slope.sign() > 0) == greater_ ? 0 : -slope.sign();
  }

  bool satisfies(const ClippedQuadratic<ExactInteger>::Clip& clip) const {
    return side(clip, clip.low) >= 0 && side(clip, clip.high) <= 0;
  }

  float nearest_float() const {
    return rounded_by_comparison([this](std::int32_t m, int e) { return against(ExactFraction(m, e)); });
  }

 private:
  /// The sign of p + root * q - level.
  int side(const ClippedQuadratic<ExactInteger>::Clip& clip, const ExactInteger& level) const {
    const ExactInteger rest = level - clip.p;
    if (clip.q.sign() == 0) return -rest.sign();
    return clip.q.sign() > 0 ? against({rest, clip.q}) : -against({-rest, -clip.q});
  }

  const ClippedQuadratic<ExactInteger>& q_;
  bool greater_;
};

[[gnu::noinline]] float decide_exactly(const Ray& ray, const Quadric& quadric) {
  ExactUnit unit;
  for (const Vec3& v : {ray.origin, ray.direction, quadric.base, quadric.apex}) unit.admit(v);
  unit.admit(quadric.base_radius);
  unit.admit(quadric.apex_radius);
  const auto base = unit(quadric.base);
  const ExactInteger r = unit(quadric.base_radius);
  auto quadratic = on_line(
      quadric.kind, QuadricQuery<ExactInteger>{unit(ray.origin) - base, unit(ray.direction),
                                               unit(quadric.apex) - base, r, unit(quadric.apex_radius) - r});
  auto& [a, b, c, discriminant, clip] = quadratic;
  if (a.sign() == 0 ? b.sign() == 0 : discriminant.sign() < 0) return no_hit;
  if (a.sign() < 0) a = -a, b = -b, c = -c;
  float best = no_hit;
  for (const bool greater : {false, true}) {
    const ExactRoot root(quadratic, greater);
    if (!clip || root.satisfies(*clip)) best = std::min(best, within(ray, root.nearest_float()));
  }
  return best;
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
