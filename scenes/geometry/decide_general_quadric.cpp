#include <array>
#include <span>

#include "scenes/geometry/clipped_roots.h"
#include "scenes/geometry/decide.h"

namespace raymeter {
namespace {

/// The polynomial and a ray as the formulas want them, in any arithmetic. Twice the polynomial is
/// x . M x + 2 (linear . x) + 2 constant.
template <class Number>
struct GeneralQuery {
  Vector3<Number> origin, direction;  ///< the origin relative to the centre
  Vector3<Number> diagonal;           ///< of M: twice q0, q1, q2
  Number xy, yz, zx;                  ///< the rest of M: q3, q4, q5
  Vector3<Number> linear;
  Number constant;
};

template <class Number>
Quadratic<Number> on_line(const GeneralQuery<Number>& q) {
  const auto &w = q.origin, &d = q.direction;
  const auto times_matrix = [&](const Vector3<Number>& v) -> Vector3<Number> {
    return {q.diagonal.x * v.x + q.xy * v.y + q.zx * v.z, q.xy * v.x + q.diagonal.y * v.y + q.yz * v.z,
            q.zx * v.x + q.yz * v.y + q.diagonal.z * v.z};
  };
  const auto gradient = times_matrix(w) + q.linear;
  const Number a = dot(d, times_matrix(d)), b = dot(d, gradient),
               c = dot(w, gradient + q.linear) + q.constant + q.constant;
  return {a, b, c, b * b - a * c};
}

/// The first stage: doubles with running error bounds. Nothing is scaled: a product of six floats, such as
/// the discriminant is made of, neither overflows a double nor underflows.
float decide_bounded(const Ray& ray, const GeneralQuadric& quadric) {
  const auto exact = [](float x) { return Bounded{flushed(x), 0}; };
  const auto twice = [](float x) { return Bounded{2.0 * flushed(x), 0}; };
  const auto difference = [](float x, float y) {
    return Bounded::result(double(flushed(x)) - double(flushed(y)), 0);
  };
  const auto& q = quadric.coefficients;
  GeneralQuery<Bounded> query{{},          {},          {twice(q[0]), twice(q[1]), twice(q[2])}, exact(q[3]),
                              exact(q[4]), exact(q[5]), {exact(q[6]), exact(q[7]), exact(q[8])}, exact(q[9])};
  // The line's points are o + (start + s) d, with `start` where the line is nearest to the middle of the
  // clip: from there, not from afar, the discriminant loses few digits (after Haines, Guenther and
  // Akenine-Moeller, "Precision Improvements for Ray/Sphere Intersection", 2019).
  std::array<Clip<Bounded>, 3> clips;
  double along = 0, square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Clip<Bounded>& clip = clips[static_cast<std::size_t>(axis)];
    const Bounded d = exact(ray.direction[axis]), w = difference(ray.origin[axis], quadric.centre[axis]);
    clip = {w, d, difference(quadric.clip.low[axis], quadric.centre[axis]),
            difference(quadric.clip.high[axis], quadric.centre[axis])};
    along += (0.5 * (clip.low.value + clip.high.value) - w.value) * d.value;
    square += d.value * d.value;
  }
  const Bounded start{along / square, 0};
  for (int axis = 0; axis < 3; ++axis) {
    Clip<Bounded>& clip = clips[static_cast<std::size_t>(axis)];
    clip.p = clip.p + start * clip.q;
    query.origin[axis] = clip.p, query.direction[axis] = clip.q;
  }
  return least_t(ray, on_line(query), std::span<const Clip<Bounded>>(clips),
                 [&](const Bounded& root) { return start + root; });
}

/// The second stage: integers. Lengths are in one unit, of which 1 is a whole number, and coefficients in
/// another.
[[gnu::noinline]] float decide_exactly(const Ray& ray, const GeneralQuadric& quadric) {
  ExactUnit unit, of_coefficients;
  unit.admit(1.0f);
  for (const Vec3& v : {ray.origin, ray.direction, quadric.centre, quadric.clip.low, quadric.clip.high})
    unit.admit(v);
  for (const float x : quadric.coefficients) of_coefficients.admit(x);
  const auto q = [&](std::size_t i) { return of_coefficients(quadric.coefficients[i]); };
  const ExactInteger one = unit(1.0f);
  const auto centre = unit(quadric.centre), w = unit(ray.origin) - centre, d = unit(ray.direction),
             low = unit(quadric.clip.low) - centre, high = unit(quadric.clip.high) - centre;
  const GeneralQuery<ExactInteger> query{w,
                                         d,
                                         {2 * q(0), 2 * q(1), 2 * q(2)},
                                         q(3),
                                         q(4),
                                         q(5),
                                         one * Vector3<ExactInteger>{q(6), q(7), q(8)},
                                         one * one * q(9)};
  std::array<Clip<ExactInteger>, 3> clips;
  for (int axis = 0; axis < 3; ++axis)
    clips[static_cast<std::size_t>(axis)] = {w[axis], d[axis], low[axis], high[axis]};
  return least_t(ray, on_line(query), std::span<const Clip<ExactInteger>>(clips));
}

}  // namespace

float decide(const Ray& ray, const GeneralQuadric& quadric) {
  if (!is_traceable(ray) || !is_finite(quadric)) return no_hit;
  const float t = decide_bounded(ray, quadric);
  return std::isnan(t) ? decide_exactly(ray, quadric) : t;
}

}  // namespace raymeter
