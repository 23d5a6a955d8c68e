// `decide` for many rays, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_DECIDE_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_DECIDE_LANES_INL
#undef RAYMETER_DECIDE_LANES_INL
#else
#define RAYMETER_DECIDE_LANES_INL
#endif

#include "accel/ray_packet-inl.h"
#include "scenes/geometry/double_stage.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

using HalfFloats = hn::Half<Floats>;
using Doubles = hn::Rebind<double, HalfFloats>;
using DoubleVector = hn::Vec<Doubles>;
inline constexpr std::size_t double_lanes = lanes / 2;

/// Where each of the rays `wanted` meets the plane of its triangle: the double stage of `decide_inside`
/// (decide_triangle.cpp), with its bounds. Returns the rays for which that says what t is, and sets it, or
/// `no_hit` where it is outside the ray's interval. corner(row, ray) are coordinates, as TriangleRows has
/// rows of them, for the rays ray, ray + 1, ...
///
/// What is lost of a direction that is scaled, 2^-126 of its norm, is nothing beside the bounds.
template <class Corner>
HWY_INLINE PacketMask decide_planes(const RayPacket& rays, PacketMask wanted, const Corner& corner,
                                    PacketFloats& t) {
  struct Vector {
    DoubleVector x, y, z;
  };
  const Doubles d;
  const HalfFloats df;
  const auto minus = [](const Vector& a, const Vector& b) {
    return Vector{hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
  };
  const auto dot = [](const Vector& a, const Vector& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
  };
  const auto norm = [&](const Vector& a) {
    return hn::Add(hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z)),
                   hn::Set(d, double_stage::tiny));
  };
  PacketMask decided = 0;
  for (std::size_t first = 0; first < packet_size; first += double_lanes) {
    if ((wanted >> first & ((PacketMask{1} << double_lanes) - 1)) == 0) continue;
    const auto get = [&](const PacketFloats& floats) {
      return hn::PromoteTo(d, hn::Load(df, &floats.numbers[first]));
    };
    const auto get3 = [&](const PacketFloats3& floats) {
      return Vector{get(floats[0]), get(floats[1]), get(floats[2])};
    };
    const auto corner3 = [&](std::size_t row) {
      return Vector{corner(row, first), corner(row + 1, first), corner(row + 2, first)};
    };
    const DoubleVector scale = get(rays.scale);
    Vector direction = get3(rays.direction);
    direction = {hn::Mul(direction.x, scale), hn::Mul(direction.y, scale), hn::Mul(direction.z, scale)};
    const Vector ta = corner3(0), a = minus(ta, get3(rays.origin)), e1 = minus(corner3(3), ta),
                 e2 = minus(corner3(6), ta);
    const Vector n{hn::MulSub(e1.y, e2.z, hn::Mul(e1.z, e2.y)), hn::MulSub(e1.z, e2.x, hn::Mul(e1.x, e2.z)),
                   hn::MulSub(e1.x, e2.y, hn::Mul(e1.y, e2.x))};
    const DoubleVector det = dot(direction, n), height = dot(a, n);
    const DoubleVector area_error =
        hn::Mul(hn::Set(d, double_stage::plane_error), hn::Mul(norm(e1), norm(e2)));
    const DoubleVector det_error = hn::Mul(area_error, norm(direction)),
                       height_error = hn::Mul(area_error, norm(a));
    const auto steep = hn::Lt(det_error, hn::Mul(hn::Abs(det), hn::Set(d, 0x1p-10)));
    const DoubleVector inverse = hn::Div(hn::Set(d, 1.0), det), at = hn::Mul(height, inverse),
                       size = hn::Abs(at);
    const DoubleVector error =
        hn::MulAdd(hn::Mul(hn::Set(d, 1.01), hn::MulAdd(size, det_error, height_error)), hn::Abs(inverse),
                   hn::Mul(size, hn::Set(d, 0x1p-50)));
    const DoubleVector low = hn::PromoteTo(d, hn::DemoteTo(df, hn::Sub(at, error))),
                       high = hn::PromoteTo(d, hn::DemoteTo(df, hn::Add(at, error)));
    // Near the ends of the floats' range, rounding is not what `rounded` does.
    const auto known = hn::And(
        hn::Eq(low, high), hn::And(hn::Gt(size, hn::Set(d, 0x1p-120)), hn::Lt(size, hn::Set(d, 0x1p120))));
    const auto out = hn::Or(hn::Le(high, get(rays.tnear)), hn::Gt(low, get(rays.tfar)));
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::And(steep, hn::Or(known, out)), reinterpret_cast<std::uint8_t*>(&bits));
    decided |= static_cast<PacketMask>(bits << first);
    const auto answer = hn::IfThenElse(out, hn::Set(d, double(no_hit)), low);
    hn::Store(hn::DemoteTo(df, answer), df, &t.numbers[first]);
  }
  return decided & wanted;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
