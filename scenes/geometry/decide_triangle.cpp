#include <algorithm>

#include "scenes/geometry/decide.h"
#include "scenes/geometry/double_stage.h"
#include "scenes/geometry/exact.h"
#include "scenes/geometry/rounding.h"

namespace raymeter {
namespace {

using double_stage::edge_error, double_stage::plane_error, double_stage::tiny;

double norm(const Vec3d& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) + tiny;
}

/// The same in exact arithmetic, for everything that the double stage left open.
[[gnu::noinline]] float decide_exactly(const Ray& ray, const Triangle& triangle) {
  if (!is_finite(triangle.a) || !is_finite(triangle.b) || !is_finite(triangle.c)) return no_hit;
  // The triangles without area that files are full of; all their rays come here.
  if (triangle.a == triangle.b || triangle.b == triangle.c || triangle.c == triangle.a) return no_hit;
  ExactUnit unit;
  for (const Vec3& v : {ray.origin, ray.direction, triangle.a, triangle.b, triangle.c}) unit.admit(v);
  const auto o = unit(ray.origin), d = unit(ray.direction);
  const auto a = unit(triangle.a) - o, b = unit(triangle.b) - o, c = unit(triangle.c) - o;

  const ExactInteger u = dot(d, cross(c, b)), v = dot(d, cross(a, c)), w = dot(d, cross(b, a));
  if ((u.sign() < 0 || v.sign() < 0 || w.sign() < 0) && (u.sign() > 0 || v.sign() > 0 || w.sign() > 0))
    return no_hit;
  // The three edge functions sum to d . N: when they agree, it is 0 only if all of them are.
  const ExactInteger det = -(u + v + w);
  if (det.sign() == 0) return no_hit;
  const ExactInteger height = dot(a, cross(b - a, c - a));
  return within(ray, rounded_by_comparison([&](std::int32_t m, int e) {
                  const ExactFraction h(m, e);
                  return ExactInteger(height * h.denominator - h.numerator * det).sign() * det.sign();
                }));
}

}  // namespace

float decide(const Ray& ray, const Triangle& triangle) {
  if (!is_traceable(ray)) return no_hit;
  const Vec3d o = to_double(ray.origin), d = to_double(ray.direction);
  const Vec3d ta = to_double(triangle.a), tb = to_double(triangle.b), tc = to_double(triangle.c);

  // On which side of each edge does the ray's line pass? d . (q x p) = d . ((q - o) x (p - o)) for edge pq.
  const Vec3d a = ta - o, b = tb - o, c = tc - o;
  const double u = dot(d, cross(c, b)), v = dot(d, cross(a, c)), w = dot(d, cross(b, a));
  const double direction_norm = norm(d), reach = std::max({norm(a), norm(b), norm(c)});
  const double side_error = edge_error * direction_norm * reach * reach;
  const double least = std::min({u, v, w}), greatest = std::max({u, v, w});
  if (least < -side_error && greatest > side_error) return no_hit;
  if (!(least > side_error || greatest < -side_error)) return decide_exactly(ray, triangle);

  return decide_inside(ray, triangle);
}

float decide_inside(const Ray& ray, const Triangle& triangle) {
  const Vec3d d = to_double(ray.direction);
  const Vec3d ta = to_double(triangle.a), a = ta - to_double(ray.origin);
  const double direction_norm = norm(d);

  // Where does it meet the plane? t = (a . N) / (d . N).
  const Vec3d e1 = to_double(triangle.b) - ta, e2 = to_double(triangle.c) - ta, n = cross(e1, e2);
  const double det = dot(d, n), height = dot(a, n);
  const double area_error = plane_error * norm(e1) * norm(e2);
  const double det_error = area_error * direction_norm, height_error = area_error * norm(a);
  if (!(det_error < 0x1p-10 * std::abs(det))) return decide_exactly(ray, triangle);
  const double inverse = 1 / det, t = height * inverse;
  // |T*/D* - T/D| <= (|T - T*| + |T/D| |D - D*|) / |D*|, and |D| < 1.001 |D*|; 8u for the rest.
  const double t_error =
      1.01 * (height_error + std::abs(t) * det_error) * std::abs(inverse) + 0x1p-50 * std::abs(t);
  const float answer = within(ray, t, t_error);
  return std::isnan(answer) ? decide_exactly(ray, triangle) : answer;
}

}  // namespace raymeter
