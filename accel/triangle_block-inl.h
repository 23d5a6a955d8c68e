// One ray against as many triangles as a vector has lanes, for the instruction set of HWY_TARGET: included
// once for each.
#if defined(RAYMETER_TRIANGLE_BLOCK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_TRIANGLE_BLOCK_INL
#undef RAYMETER_TRIANGLE_BLOCK_INL
#else
#define RAYMETER_TRIANGLE_BLOCK_INL
#endif

#include <algorithm>
#include <limits>

#include "accel/brick_ray-inl.h"

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

HWY_INLINE FloatVec3 minus(const FloatVec3& a, const FloatVec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE FloatVector norm_of(const FloatVec3& v) {
  return hn::Add(hn::Add(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
}

/// `t` of the ray's direction as one of FilterRay's, moved by so much of itself that all roundings are paid
/// for.
HWY_INLINE float scaled_up(const FilterRay& ray, float t) {
  const double scaled = std::max(t, FLT_MIN) * ray.scale * (1 + 0x1p-20);
  return scaled < FLT_MAX ? static_cast<float>(scaled) : std::numeric_limits<float>::infinity();
}
HWY_INLINE float scaled_down(const FilterRay& ray, float t) {
  return static_cast<float>(std::min(t * ray.scale * (1 - 0x1p-20), double(FLT_MAX)));
}

/// The interval in which hits matter, in FilterRay's scaled t: floats that are certainly outside it, and such
/// as are certainly inside. For rays that BrickRay takes.
struct FilterInterval {
  explicit HWY_INLINE FilterInterval(const FilterRay& ray)
      : before(scaled_down(ray, ray.ray.tnear)),
        after(scaled_up(ray, ray.ray.tfar)),
        inside_from(scaled_up(ray, ray.ray.tnear)),
        inside_to(scaled_down(ray, std::min(ray.ray.tfar, FLT_MAX))) {}

  float before, after;  ///< nothing at or below `before`, or above `after`, matters
  float inside_from, inside_to;
};

/// The answers of filter.h's test for a block of triangles, with its error bounds.
struct BlockTest {
  hn::Mask<Floats> candidates;  ///< may be hit in the interval
  hn::Mask<Floats> inside;      ///< the ray's line certainly passes inside: `decide_inside` will do
  hn::Mask<Floats> certain;     ///< of these, the ones that `decide` certainly accepts in the whole interval
  FloatVector height, height_error, det, det_error;  ///< t is height / det, det > 0

  /// Bounds of the t of certain ones.
  HWY_INLINE FloatVector least_t() const {
    const Floats d;
    return hn::Mul(hn::Div(hn::Sub(height, height_error), hn::Add(det, det_error)), hn::Set(d, 1 - 0x1p-20f));
  }
  HWY_INLINE FloatVector greatest_t() const {
    const Floats d;
    return hn::Mul(hn::Div(hn::Add(height, height_error), hn::Sub(det, det_error)), hn::Set(d, 1 + 0x1p-20f));
  }
};

/// The triangles first, first + 1, ... of a leaf's rows of `count` floats (bricks.h).
HWY_INLINE BlockTest test_block(const FilterRay& ray, const std::uint32_t* words, std::uint32_t count,
                                std::uint32_t first, const FilterInterval& interval) {
  const Floats d;
  const std::uint32_t* row = words + first;
  const auto next = [&] {
    const FloatVector vector = hn::BitCast(d, hn::LoadU(hn::Repartition<std::uint32_t, Floats>(), row));
    row += count;
    return vector;
  };
  const auto next3 = [&] {
    FloatVec3 v;
    v.x = next();
    v.y = next();
    v.z = next();
    return v;
  };
  const FloatVec3 a = next3(), e1 = minus(next3(), a), e2 = minus(next3(), a);
  const FloatVec3 direction{hn::Set(d, ray.direction.x), hn::Set(d, ray.direction.y),
                            hn::Set(d, ray.direction.z)};
  const FloatVec3 s{hn::Sub(hn::Set(d, ray.ray.origin.x), a.x), hn::Sub(hn::Set(d, ray.ray.origin.y), a.y),
                    hn::Sub(hn::Set(d, ray.ray.origin.z), a.z)};

  // Moeller & Trumbore 1997.
  const FloatVec3 p = cross_of(direction, e2), q = cross_of(s, e1);
  const FloatVector signed_det = dot_of(e1, p), u = dot_of(s, p), v = dot_of(direction, q);
  const FloatVector w = hn::Sub(hn::Sub(signed_det, u), v);
  const FloatVector reach = hn::Add(norm_of(s), hn::Set(d, filter::tiny));
  const FloatVector edges = hn::Add(hn::Max(norm_of(e1), norm_of(e2)), hn::Set(d, filter::tiny));
  const FloatVector edges2 = hn::Mul(edges, edges);
  const FloatVector area = hn::MulAdd(hn::Add(edges, edges), reach, edges2);
  const FloatVector volume = hn::Mul(edges2, reach);
  const FloatVector side_error = hn::Mul(area, hn::Set(d, 0x1.8p-20f));
  const FloatVector least = hn::Min(hn::Min(u, v), w), greatest = hn::Max(hn::Max(u, v), w);
  const FloatVector large = hn::Set(d, filter::large);
  // Where something may have overflowed nothing is rejected, and nothing is certain.
  const auto bounded = hn::And(hn::Lt(area, large), hn::Lt(volume, large));
  const auto outside = hn::And(hn::Lt(least, hn::Neg(side_error)), hn::Gt(greatest, side_error));
  const auto inside = hn::Or(hn::Gt(least, side_error), hn::Lt(greatest, hn::Neg(side_error)));

  BlockTest test;
  const FloatVector error = hn::Set(d, 0x1p-20f);
  test.det = hn::Abs(signed_det);
  test.det_error = hn::Mul(edges2, error);
  test.height = hn::Xor(dot_of(e2, q), hn::And(signed_det, hn::SignBit(d)));
  test.height_error = hn::Mul(volume, error);
  const FloatVector least_det = hn::Sub(test.det, test.det_error),
                    greatest_det = hn::Add(test.det, test.det_error);
  const FloatVector lowest = hn::Sub(test.height, test.height_error),
                    highest = hn::Add(test.height, test.height_error);
  const auto steep = hn::Gt(least_det, hn::Zero(d));
  const auto beyond = hn::Or(hn::Gt(lowest, hn::Mul(hn::Set(d, interval.after), greatest_det)),
                             hn::Lt(highest, hn::Mul(hn::Set(d, interval.before), least_det)));
  const auto rejected = hn::And(bounded, hn::Or(outside, hn::And(steep, beyond)));
  const auto there = hn::FirstN(d, count - first);
  test.candidates = hn::AndNot(rejected, there);
  test.inside = hn::And(bounded, inside);
  test.certain = hn::And(hn::And(hn::And(test.candidates, test.inside), hn::Gt(least_det, test.det_error)),
                         hn::And(hn::Gt(lowest, hn::Mul(hn::Set(d, interval.inside_from), greatest_det)),
                                 hn::Le(highest, hn::Mul(hn::Set(d, interval.inside_to), least_det))));
  return test;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
