// One ray against as many triangles as a vector has lanes, for the instruction set of HWY_TARGET: included
// once for each.
#if defined(RAYMETER_TRIANGLE_BLOCK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_TRIANGLE_BLOCK_INL
#undef RAYMETER_TRIANGLE_BLOCK_INL
#else
#define RAYMETER_TRIANGLE_BLOCK_INL
#endif

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "accel/brick_cells-inl.h"
#include "accel/triangle_rows.h"
#include "scenes/geometry/decide.h"
#include "scenes/geometry/rounding.h"
#include "scenes/geometry/vec3.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

struct FloatVec3 {
  FloatVector x, y, z;
};
HWY_INLINE FloatVec3 cross_of(const FloatVec3& a, const FloatVec3& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE FloatVector dot_of(const FloatVec3& a, const FloatVec3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE FloatVec3 absolute(const FloatVec3& v) {
  return {hn::Abs(v.x), hn::Abs(v.y), hn::Abs(v.z)};
}
HWY_INLINE FloatVector norm_of(const FloatVec3& v) {
  const FloatVec3 a = absolute(v);
  return hn::Add(hn::Add(a.x, a.y), a.z);
}
HWY_INLINE FloatVec3 minus(const FloatVec3& a, const FloatVec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// A t of a ray as one of the ray with its direction over `scale`, a power of two: at least that, or at most,
/// by more than all roundings.
inline float scaled_up(float t, float scale) {
  return std::max(t, FLT_MIN) * scale * (1 + 0x1p-20f) + FLT_MIN;
}
inline float scaled_down(float t, float scale) {
  return std::min(t, FLT_MAX) * scale * (1 - 0x1p-20f);
}

/// Intervals of scaled t: outside and inside of what is certain.
struct LaneIntervals {
  FloatVector before, after;           ///< nothing at or below `before`, or above `after`, matters
  FloatVector inside_from, inside_to;  ///< everything between these does
};

/// Rays against triangles, lane by lane: one in all lanes against several.
struct BlockTest {
  std::uint64_t candidates = 0;  ///< the ray's line may pass through the triangle
  FloatVector det, height;       ///< t is height / det
  FloatVec3 s, e1, e2;           ///< from the first corner to the ray's origin and to the other corners
  FloatVector edge;              ///< in TriangleRows::edge_unit
  FloatVector least, greatest;   ///< of the three numbers that say on which side of the edges it passes
  FloatVector error;             ///< of these

  /// Of the candidates and others: the line certainly passes through, and not through an edge.
  HWY_INLINE std::uint64_t inside() const {
    return bits_of(hn::Or(hn::Gt(least, error), hn::Lt(greatest, hn::Neg(error))));
  }

  /// Of |det| and of the height with its sign; infinite where something may have overflowed.
  struct Bounds {
    FloatVector least_det, greatest_det, lowest, highest;
    hn::Mask<Floats> steep;  ///< t is known at all

    /// Of t, where it is certain.
    HWY_INLINE FloatVector least_t() const {
      return hn::Mul(hn::Div(lowest, greatest_det), hn::Set(Floats(), 1 - 0x1p-20f));
    }
    HWY_INLINE FloatVector greatest_t() const {
      return hn::Mul(hn::Div(highest, least_det), hn::Set(Floats(), 1 + 0x1p-20f));
    }
  };

  struct Hits {
    std::uint64_t possible;  ///< of the candidates: t may lie in the interval
    std::uint64_t certain;   ///< of these: passed inside, and `decide` certainly accepts it
  };
  /// What t says of the candidates; sets its bounds.
  HWY_INLINE Hits within(const LaneIntervals& interval, Bounds& t) const {
    t = bounds(height_error_by_norms());
    const Hits hits = within_bounds(interval, t);
    // Nearly always a ray that leaves the triangle that it starts on.
    if ((hits.possible & ~hits.certain & inside()) == 0) return hits;
    t = bounds(height_error_by_products());
    return within_bounds(interval, t);
  }

 private:
  static constexpr float unit = TriangleRows::edge_unit;
  /// Multiplied with lengths before it is scaled, this overflows before the height does.
  HWY_INLINE FloatVector edge_squared() const { return hn::Mul(edge, edge); }

  /// As in filter.h. A bound by the cell would do in place of the distance, but not tell that a ray leaves
  /// the triangle that it starts on.
  HWY_INLINE FloatVector height_error_by_norms() const {
    const Floats d;
    const FloatVector away = hn::Add(norm_of(s), hn::Set(d, filter::tiny));
    return hn::Mul(hn::Mul(edge_squared(), away), hn::Set(d, 0x1p-20f / (unit * unit)));
  }
  /// The height is a sum of six products of a coordinate each of s, e1 and e2. Its error is at most 8u of the
  /// sum of their absolute values: three roundings for the factors, two for q, three for the dot product.
  /// By norms it may be ten times as much, and more for a triangle across an axis. Overflow comes sooner by a
  /// factor of 4; the last term pays for what is flushed, 2^-126 times (1 + edge)^2 (1 + |s|) at most some
  /// thirty times, as the edge is at least filter::tiny.
  HWY_INLINE FloatVector height_error_by_products() const {
    const Floats d;
    const FloatVec3 a = absolute(s), b = absolute(e1);
    const FloatVec3 ab{hn::MulAdd(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulAdd(a.z, b.x, hn::Mul(a.x, b.z)),
                       hn::MulAdd(a.x, b.y, hn::Mul(a.y, b.x))};
    const FloatVector products = hn::Mul(dot_of(absolute(e2), ab), hn::Set(d, 4.0f));
    const FloatVector flushed = hn::Mul(edge_squared(), hn::Add(norm_of(s), hn::Set(d, 1.0f)));
    return hn::MulAdd(products, hn::Set(d, 0x1.1p-23f),
                      hn::Mul(flushed, hn::Set(d, 0x1p-52f / (unit * unit))));
  }

  HWY_INLINE Bounds bounds(FloatVector height_error) const {
    const Floats d;
    const FloatVector det_error = hn::Mul(edge_squared(), hn::Set(d, 0x1p-20f / (unit * unit)));
    const FloatVector positive = hn::Abs(det), along = hn::Xor(height, hn::And(det, hn::SignBit(d)));
    const FloatVector least_det = hn::Sub(positive, det_error);
    return {least_det, hn::Add(positive, det_error), hn::Sub(along, height_error),
            hn::Add(along, height_error), hn::Gt(least_det, det_error)};
  }
  HWY_INLINE Hits within_bounds(const LaneIntervals& interval, const Bounds& t) const {
    const auto beyond = hn::Or(hn::Gt(t.lowest, hn::Mul(interval.after, t.greatest_det)),
                               hn::Lt(t.highest, hn::Mul(interval.before, t.least_det)));
    const auto between = hn::And(hn::Gt(t.lowest, hn::Mul(interval.inside_from, t.greatest_det)),
                                 hn::Le(t.highest, hn::Mul(interval.inside_to, t.least_det)));
    const std::uint64_t possible = candidates & ~bits_of(hn::And(t.steep, beyond));
    return {possible, possible & inside() & bits_of(hn::And(t.steep, between))};
  }
};

/// Triangles, one in each lane: a corner and the edges from it to the others.
struct LaneTriangles {
  FloatVec3 a, e1, e2;
};

/// Rays against triangles. edge_of(): as in TriangleRows, asked for when the rest is done. `reach`: an upper
/// bound of the 1-norm from each ray's origin to some point of its triangle. `there`: the lanes that count.
///
/// Moeller & Trumbore 1997. Which side of each edge does the line pass? The error bounds are those of
/// filter.h. What they call reach, the distance of a triangle's first corner, is at most that of any
/// point of its bounding box and twice the edge.
template <class Edge>
HWY_INLINE BlockTest test_lanes(const FloatVec3& origin, const FloatVec3& direction,
                                const LaneTriangles& triangles, const Edge& edge_of, FloatVector reach,
                                std::uint64_t there) {
  const Floats d;
  const FloatVec3 s = minus(origin, triangles.a);
  const FloatVec3 p = cross_of(direction, triangles.e2), q = cross_of(s, triangles.e1);
  const FloatVector det = dot_of(triangles.e1, p), u = dot_of(s, p), v = dot_of(direction, q);
  const FloatVector w = hn::Sub(hn::Sub(det, u), v);

  // 0x1.8p-20 * edge * (edge + 2 * (reach + 2 * edge)), infinite where something may have overflowed: nothing
  // is rejected then, and nothing is certain.
  const FloatVector edge = edge_of();
  const FloatVector area =
      hn::Mul(edge, hn::MulAdd(edge, hn::Set(d, 5 / TriangleRows::edge_unit), hn::Add(reach, reach)));
  const FloatVector error = hn::Mul(area, hn::Set(d, 0x1.8p-20f / TriangleRows::edge_unit));
  const FloatVector least = hn::Min(hn::Min(u, v), w), greatest = hn::Max(hn::Max(u, v), w);
  const auto outside = hn::And(hn::Lt(least, hn::Neg(error)), hn::Gt(greatest, error));
  return {there & ~bits_of(outside),
          det,
          dot_of(triangles.e2, q),
          s,
          triangles.e1,
          triangles.e2,
          edge,
          least,
          greatest,
          error};
}

/// The triangles first, first + 1, ... of `rows`.
HWY_INLINE LaneTriangles triangles_of(const TriangleRows& rows, std::uint32_t first) {
  const Floats d;
  const float* row = rows.row(0) + first;
  const auto next = [&] {
    const FloatVector vector = hn::LoadU(d, row);
    row += rows.count;
    return vector;
  };
  const auto next3 = [&] {
    FloatVec3 v;
    v.x = next();
    v.y = next();
    v.z = next();
    return v;
  };
  LaneTriangles triangles;
  triangles.a = next3();
  triangles.e1 = minus(next3(), triangles.a);
  triangles.e2 = minus(next3(), triangles.a);
  return triangles;
}
/// The bits of as many lanes as there are triangles from `first` on.
HWY_INLINE std::uint64_t lanes_from(const TriangleRows& rows, std::uint32_t first) {
  return (std::uint64_t{1} << std::min<std::size_t>(rows.count - first, lanes)) - 1;
}

/// A ray, in all lanes, against these. `reach`: an upper bound of the 1-norm from its origin to some point of
/// each one's bounding box.
HWY_INLINE BlockTest test_block(const FloatVec3& origin, const FloatVec3& direction, const TriangleRows& rows,
                                std::uint32_t first, float reach) {
  const Floats d;
  return test_lanes(
      origin, direction, triangles_of(rows, first),
      [&] { return hn::LoadU(d, rows.row(TriangleRows::edge_row) + first); }, hn::Set(d, reach),
      lanes_from(rows, first));
}

/// Where the ray's line meets the plane of a triangle, in double: t = height / det within the errors, det >
/// 0, for the ray as given. As decide_inside, and with its bounds, of which `edge` and `reach` (see
/// test_block) bound the norms.
struct PlaneHit {
  double height, det, height_error, det_error;

  /// `scale`: at least half of the 1-norm of the direction.
  HWY_INLINE PlaneHit(const Ray& ray, double scale, const Triangle& triangle, double edge, double reach) {
    const Vec3d d = to_double(ray.direction), ta = to_double(triangle.a), a = ta - to_double(ray.origin);
    const Vec3d n = cross(to_double(triangle.b) - ta, to_double(triangle.c) - ta);
    const double signed_det = dot(d, n), signed_height = dot(a, n);
    det = std::abs(signed_det);
    height = signed_det < 0 ? -signed_height : signed_height;
    constexpr double error = 10 * 0x1p-53;
    const double area_error = error * edge * edge;
    det_error = area_error * (2 * scale);
    height_error = area_error * (reach + 2 * edge);
  }
  struct Interval {
    float low, high;
  };
  /// Bounds of t as a float, where it is known.
  HWY_INLINE Interval t() const {
    const double inverse = 1 / det, t = height * inverse;
    const double error = 1.01 * (height_error + std::abs(t) * det_error) * inverse + 0x1p-50 * std::abs(t);
    return {rounded(t - error), rounded(t + error)};
  }
  /// Whether the errors leave something to be said.
  bool known() const { return det_error < 0x1p-10 * det; }
};

/// Whether `decide` gives a hit, for a candidate of test_block. `inside`: as of that.
HWY_INLINE bool decide_any(const Ray& ray, float scale, const TriangleRows& rows, std::uint32_t column,
                           bool inside, float reach) {
  const Triangle triangle = rows.triangle(column);
  const PlaneHit plane(ray, scale, triangle, rows.edge(column), reach);
  if (plane.known()) {
    // Room for the rounding of t to a float.
    constexpr double more = 1 + 0x1p-22, less = 1 - 0x1p-22;
    const double low = plane.height - plane.height_error, high = plane.height + plane.height_error;
    const double least_det = plane.det - plane.det_error, greatest_det = plane.det + plane.det_error;
    const double tnear = ray.tnear, tfar = ray.tfar;
    if (high < tnear * less * least_det || low > std::max(tfar, double(FLT_MIN)) * more * greatest_det)
      return false;
    if (inside && low > std::max(tnear, double(FLT_MIN)) * more * greatest_det &&
        high < std::min(tfar, double(FLT_MAX)) * less * least_det)
      return true;
  }
  return decide(ray, triangle) != no_hit;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
