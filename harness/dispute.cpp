#include "harness/dispute.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "scenes/geometry/decide.h"

namespace raymeter {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double unit = 0x1p-24;                  // half an ulp of a float, relative
constexpr double most_displacement = 0x1p-12;     // of a hit, over its distance
constexpr double edge_nearness = 0x1p-20;         // barycentric, at least
constexpr double most_edge_nearness = 0x1p-10;    // barycentric, however bad a kernel's rounding
constexpr double grazing_cosine = 0x1p-12;        // between direction and normal
constexpr double grazing_discriminant = 0x1p-20;  // over the terms that it is the difference of
constexpr double degenerate_area = 0x1p-20;       // over the longest edge's square
constexpr int limit_ulps = 4;

/// A triangle as the ray's origin sees it.
struct SeenTriangle {
  SeenTriangle(const Ray& ray, const Triangle& triangle) : direction(to_double(ray.direction)) {
    const Vec3d origin = to_double(ray.origin);
    corners = {to_double(triangle.a) - origin, to_double(triangle.b) - origin,
               to_double(triangle.c) - origin};
    const Vec3d e = to_double(triangle.b) - to_double(triangle.a),
                f = to_double(triangle.c) - to_double(triangle.a);
    normal = cross(e, f);
    std::array edges = {length(e), length(f), length(f - e)};
    std::sort(edges.begin(), edges.end());
    longest_edge = edges[2];
    edge_product = edges[1] * edges[2];
    for (const Vec3d& corner : corners) farthest = std::max(farthest, length(corner));
  }

  double t() const { return dot(corners[0], normal) / dot(direction, normal); }
  double cosine() const { return std::abs(dot(direction, normal)) / (length(direction) * length(normal)); }
  /// The barycentric coordinates of the point in which the line meets the triangle's plane.
  std::array<double, 3> barycentric() const {
    const double a = dot(direction, cross(corners[2], corners[1])),
                 b = dot(direction, cross(corners[0], corners[2])),
                 c = dot(direction, cross(corners[1], corners[0])), sum = a + b + c;
    return {a / sum, b / sum, c / sum};
  }

  /// How far a float kernel's barycentric coordinates may be off. Moeller & Trumbore (1997) compute them as
  /// (C x D) . e / (N . D), with C a corner, D the direction and e an edge, all rounded to float: to first
  /// order the numerator is off by 8 u |C||D||e|. Twice that, with the farthest corner and the longest edge.
  double edge_bound() const {
    const double bound =
        16 * unit * farthest * length(direction) * longest_edge / std::abs(dot(normal, direction));
    return std::clamp(bound, edge_nearness, most_edge_nearness);
  }

  Vec3d direction, normal;
  std::array<Vec3d, 3> corners;
  double longest_edge = 0, edge_product = 0, farthest = 0;
};

/// a t^2 + 2 b t + c = 0 where the line meets the quadric's infinite surface. Of that, the part counts where
/// each height at_0 + t * slope is between 0 and 1: along an axis from base to apex, or across a clip box.
struct SeenQuadric {
  struct Height {
    double at_0, slope;
  };

  SeenQuadric(const Ray& ray, const Quadric& q) {
    const Vec3d w = to_double(ray.origin) - to_double(q.base), d = to_double(ray.direction);
    const double r = q.base_radius;
    if (q.kind == QuadricKind::sphere) {
      a = dot(d, d), b = dot(d, w), c = dot(w, w) - r * r;
      return;
    }
    const Vec3d axis = to_double(q.apex) - to_double(q.base), u = cross(d, axis), v = cross(w, axis);
    const double l = dot(axis, axis), delta = double(q.apex_radius) - r, p = dot(d, axis),
                 s = l * r + delta * dot(w, axis);
    a = l * dot(u, u) - delta * delta * p * p;
    b = l * dot(u, v) - delta * p * s;
    c = l * dot(v, v) - s * s;
    heights.push_back({dot(w, axis) / l, p / l});
  }

  SeenQuadric(const Ray& ray, const GeneralQuadric& quadric) {
    const Vec3d w = to_double(ray.origin) - to_double(quadric.centre), d = to_double(ray.direction);
    const auto& q = quadric.coefficients;
    // Term by term: of x y, say, the product (w.x + t d.x) (w.y + t d.y).
    const auto add = [&](double factor, int i, int j) {
      a += factor * d[i] * d[j];
      b += 0.5 * factor * (w[i] * d[j] + w[j] * d[i]);
      c += factor * w[i] * w[j];
    };
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      add(q[at], i, i);
      add(q[3 + at], i, (i + 1) % 3);
      b += 0.5 * q[6 + at] * d[i];
      c += q[6 + at] * w[i];
      // A box without thickness has no inside: its only height is an edge.
      const double low = quadric.clip.low[i], thickness = double(quadric.clip.high[i]) - low;
      heights.push_back(thickness > 0 ? Height{(ray.origin[i] - low) / thickness, d[i] / thickness}
                                      : Height{0, 0});
    }
    c += q[9];
  }

  double discriminant() const { return b * b - a * c; }
  /// The distance to the nearest cut, in parts of the whole; negative outside, infinite where nothing is cut.
  double inside(double t) const {
    double least = infinity;
    for (const Height& height : heights) {
      const double at_t = height.at_0 + t * height.slope;
      least = std::min({least, at_t, 1 - at_t});
    }
    return least;
  }

  double a = 0, b = 0, c = 0;
  std::vector<Height> heights;
};

/// Calls the function for what the ray sees of the primitive.
template <class UseTriangle, class UseQuadric>
auto see(const Scene& scene, const Ray& ray, std::uint32_t primitive, const UseTriangle& use_triangle,
         const UseQuadric& use_quadric) {
  return scene.visit(primitive, [&]<class Shape>(const Shape& shape) {
    if constexpr (std::is_same_v<Shape, Triangle>)
      return use_triangle(SeenTriangle(ray, shape));
    else
      return use_quadric(SeenQuadric(ray, shape));
  });
}

struct Range {
  double low = 0, high = 0;
};

/// Where along the ray's line it is within the primitive's box grown by what a float kernel can't resolve.
Range near(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  const Bounds box = scene.bounds_of(primitive);
  double distance = 0;
  for (int i = 0; i < 3; ++i)
    distance = std::max({distance, std::abs(double(box.low[i]) - ray.origin[i]),
                         std::abs(double(box.high[i]) - ray.origin[i])});
  const double margin = most_displacement * box.diagonal() + 16 * unit * distance;
  Range range{-infinity, infinity};
  for (int i = 0; i < 3; ++i) {
    const double low = double(box.low[i]) - margin - ray.origin[i],
                 high = double(box.high[i]) + margin - ray.origin[i];
    const double d = ray.direction[i];
    if (d == 0) {
      if (low > 0 || high < 0) return {infinity, -infinity};
      continue;
    }
    range.low = std::max(range.low, std::min(low / d, high / d));
    range.high = std::min(range.high, std::max(low / d, high / d));
  }
  return range;
}

/// Where the line meets the infinite surface of a primitive. `inside` is the least barycentric coordinate, or
/// the distance to the nearest cut: negative outside of the primitive.
struct Crossing {
  double t = 0, inside = 0;
  double edge_bound = edge_nearness;
  bool at_edge() const { return std::abs(inside) <= edge_bound; }
};

std::vector<Crossing> crossings(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  std::vector<Crossing> found;
  const auto add = [&](double t, double inside, double edge_bound = edge_nearness) {
    if (std::isfinite(t)) found.push_back({t, inside, edge_bound});
  };
  const auto of_triangle = [&](const SeenTriangle& triangle) {
    const auto coordinates = triangle.barycentric();
    add(triangle.t(), *std::min_element(coordinates.begin(), coordinates.end()), triangle.edge_bound());
  };
  const auto of_quadric = [&](const SeenQuadric& quadric) {
    if (quadric.discriminant() < 0) return;
    // The form in which neither root cancels.
    const double q = -(quadric.b + std::copysign(std::sqrt(quadric.discriminant()), quadric.b));
    for (const double t : {q / quadric.a, quadric.c / q}) add(t, quadric.inside(t));
  };
  see(scene, ray, primitive, of_triangle, of_quadric);
  return found;
}

/// The line runs along the surface.
bool is_grazing(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  return see(
      scene, ray, primitive, [](const SeenTriangle& triangle) { return triangle.cosine() < grazing_cosine; },
      [](const SeenQuadric& quadric) {
        return std::abs(quadric.discriminant()) <=
               grazing_discriminant * (quadric.b * quadric.b + std::abs(quadric.a * quadric.c));
      });
}

/// t is as near to an end of the ray's interval as a float kernel's t may be wrong.
bool at_limit(const Scene& scene, const Ray& ray, std::uint32_t primitive, double t) {
  const double bound = t_bound(scene, ray, primitive, t);
  const auto close = [&](float limit) {
    if (std::isinf(limit)) return false;
    const double ulps = limit_ulps * 2 * unit * std::abs(double(limit));
    return std::abs(t - double(limit)) <= std::max(bound, ulps);
  };
  return close(ray.tnear) || close(ray.tfar);
}

bool is_degenerate(const Scene& scene, const Ray& ray, std::uint32_t primitive) {
  if (!scene.is_triangle(primitive)) return false;
  const SeenTriangle triangle(ray, scene.triangle(primitive));
  return 0.5 * length(triangle.normal) < degenerate_area * triangle.longest_edge * triangle.longest_edge;
}

/// To first order, how far the t of a float kernel may be off, but for its last bits; and the greatest
/// distance that it computes with. `normal` is that of the surface at t.
struct KernelError {
  double t, distance;
};

KernelError kernel_error(const Ray& ray, const Triangle& shape, const Vec3d&, double t) {
  const SeenTriangle triangle(ray, shape);
  const double distance = triangle.farthest + std::abs(t) * length(triangle.direction);
  return {16 * unit * triangle.edge_product * distance / std::abs(dot(triangle.normal, triangle.direction)),
          distance};
}

KernelError kernel_error(const Ray& ray, const Quadric& q, const Vec3d& normal, double t) {
  const Vec3d direction = to_double(ray.direction);
  const double radius = std::max(q.base_radius, q.apex_radius),
               axis = q.kind == QuadricKind::sphere ? 0 : length(to_double(q.apex) - to_double(q.base)),
               distance = length(to_double(ray.origin) - to_double(q.base)) + radius + axis +
                          std::abs(t) * length(direction);
  return {16 * unit * distance * distance / (radius * std::abs(dot(direction, normal))), distance};
}

KernelError kernel_error(const Ray& ray, const GeneralQuadric& quadric, const Vec3d&, double t) {
  Vec3d reach;
  for (int i = 0; i < 3; ++i)
    reach[i] = std::abs(double(ray.origin[i]) - quadric.centre[i]) + std::abs(t * ray.direction[i]);
  const auto& q = quadric.coefficients;
  double terms = std::abs(q[9]);
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    terms += reach[i] *
             (std::abs(q[at]) * reach[i] + std::abs(q[3 + at]) * reach[(i + 1) % 3] + std::abs(q[6 + at]));
  }
  const SeenQuadric seen(ray, quadric);
  return {16 * unit * terms / std::abs(2 * (seen.a * t + seen.b)), length(reach)};
}

}  // namespace

double t_bound(const Scene& scene, const Ray& ray, std::uint32_t primitive, double t) {
  const Vec3d direction = to_double(ray.direction);
  const Vec3d normal = scene.geometric_normal(primitive, to_double(ray.origin) + t * direction);
  const KernelError error =
      scene.visit(primitive, [&](const auto& shape) { return kernel_error(ray, shape, normal, t); });
  // A NaN or infinite bound (no area, no slope) becomes the cap, too.
  const double cap = most_displacement * error.distance / length(direction);
  return (error.t < cap ? error.t : cap) + 4 * unit * std::abs(t);
}

bool within_2_ulp(float a, float b) {
  if (std::signbit(a) != std::signbit(b)) return a == b;
  const auto x = std::bit_cast<std::int32_t>(a), y = std::bit_cast<std::int32_t>(b);
  return std::abs(std::int64_t{x} - y) <= 2;
}

std::optional<Grade> explain_hit(const Scene& scene, const Ray& ray, const Hit& truth, const Hit& answer) {
  if (!truth.found() || answer.primitive >= scene.primitive_count()) return std::nullopt;
  const bool same = answer.primitive == truth.primitive;
  float t = truth.t;
  if (!same) t = scene.visit(answer.primitive, [&](const auto& shape) { return decide(ray, shape); });
  if (t == no_hit || !within_2_ulp(t, truth.t)) return std::nullopt;
  if (!(std::abs(double(answer.t) - double(t)) <= t_bound(scene, ray, answer.primitive, t)))
    return std::nullopt;
  return same ? Grade::within_bound : Grade::tie;
}

std::optional<Grade> explain_missed(const Scene& scene, const Ray& ray, std::uint32_t primitive, float t) {
  const std::vector<Crossing> found = crossings(scene, ray, primitive);
  const auto hit = std::min_element(found.begin(), found.end(), [&](const Crossing& a, const Crossing& b) {
    return std::abs(a.t - t) < std::abs(b.t - t);
  });
  if (hit != found.end() && hit->at_edge()) return Grade::edge;
  if (is_grazing(scene, ray, primitive)) return Grade::grazing;
  if (at_limit(scene, ray, primitive, t)) return Grade::at_limit;
  if (is_degenerate(scene, ray, primitive)) return Grade::degenerate;
  return std::nullopt;
}

std::optional<Grade> explain_invented(const Scene& scene, const Ray& ray, std::uint32_t primitive,
                                      std::optional<float> t) {
  // The ray must at least pass close by, where the kernel saw the hit or anywhere in the interval.
  const Range range = near(scene, ray, primitive);
  const bool passes =
      range.low <= range.high && range.low <= (t ? *t : ray.tfar) && range.high >= (t ? *t : ray.tnear);
  if (!passes) return std::nullopt;

  bool edge = false, limit = false;
  for (const Crossing& crossing : crossings(scene, ray, primitive)) {
    const double bound = t_bound(scene, ray, primitive, crossing.t);
    const bool there = t ? std::abs(crossing.t - double(*t)) <= bound
                         : crossing.t > double(ray.tnear) - bound && crossing.t <= double(ray.tfar) + bound;
    edge |= there && crossing.at_edge();
    limit |= there && crossing.inside >= 0 && at_limit(scene, ray, primitive, crossing.t);
  }
  if (edge) return Grade::edge;
  if (is_grazing(scene, ray, primitive)) return Grade::grazing;
  if (limit) return Grade::at_limit;
  if (is_degenerate(scene, ray, primitive)) return Grade::degenerate;
  return std::nullopt;
}

}  // namespace raymeter
