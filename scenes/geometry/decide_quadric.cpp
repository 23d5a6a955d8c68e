#include "scenes/geometry/decide.h"

#include <cmath>

namespace raymeter {
namespace {

float in_interval(const Ray& ray, double t) {
  const float rounded = static_cast<float>(t);
  return rounded > ray.tnear && rounded <= ray.tfar && rounded < no_hit ? rounded : no_hit;
}

}  // namespace

float decide(const Ray& ray, const Quadric& q) {
  if (!is_traceable(ray)) return no_hit;
  const Vec3d w = to_double(ray.origin) - to_double(q.base), d = to_double(ray.direction);
  double a = 0, b = 0, c = 0, l = 0, alpha = 0, beta = 0;
  const double r = q.base_radius;
  if (q.kind == QuadricKind::sphere) {
    a = dot(d, d), b = dot(d, w), c = dot(w, w) - r * r;
  } else {
    const Vec3d axis = to_double(q.apex) - to_double(q.base), u = cross(d, axis), v = cross(w, axis);
    const double delta = double(q.apex_radius) - r;
    l = dot(axis, axis), alpha = dot(d, axis), beta = dot(w, axis);
    a = l * dot(u, u) - delta * delta * alpha * alpha;
    b = l * dot(u, v) - delta * alpha * (l * r + delta * beta);
    c = l * dot(v, v) - (l * r + delta * beta) * (l * r + delta * beta);
  }
  const double disc = b * b - a * c;
  if (disc < 0 || a == 0) return no_hit;
  const double s = std::sqrt(disc), t0 = (-b - s) / a, t1 = (-b + s) / a;
  float best = no_hit;
  for (const double t : {t0, t1})
    if (q.kind == QuadricKind::sphere || (beta + t * alpha >= 0 && beta + t * alpha <= l))
      best = std::min(best, in_interval(ray, t));
  return best;
}

}  // namespace raymeter
