// Sixteen rays side by side, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_RAY_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_RAY_PACKET_INL
#undef RAYMETER_RAY_PACKET_INL
#else
#define RAYMETER_RAY_PACKET_INL
#endif

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "accel/triangle_block-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

inline constexpr std::size_t packet_size = widest_vector;
inline constexpr std::size_t packet_vectors = packet_size / lanes;

/// A bit for each ray of a packet.
using PacketMask = std::uint32_t;

/// The bits of vector v of a packet, at their place among all.
HWY_INLINE PacketMask packet_bits(std::uint64_t bits, std::size_t v) {
  return static_cast<PacketMask>(bits << (v * lanes));
}
/// And back.
HWY_INLINE std::uint64_t vector_bits(PacketMask rays, std::size_t v) {
  return rays >> (v * lanes) & ((std::uint64_t{1} << lanes) - 1);
}
HWY_INLINE hn::Mask<Floats> mask_of(std::uint64_t bits) {
  return hn::LoadMaskBits(Floats(), reinterpret_cast<const std::uint8_t*>(&bits));
}
template <class F>
HWY_INLINE void for_each_ray(PacketMask rays, F&& f) {
  for (; rays != 0; rays &= rays - 1) f(static_cast<std::size_t>(std::countr_zero(rays)));
}

/// A number for each ray of a packet.
template <class D>
struct alignas(64) PacketNumbers {
  using Tag = D;
  using Number = hn::TFromD<Tag>;
  std::array<Number, packet_size> numbers;

  Number& operator[](std::size_t ray) { return numbers[ray]; }
  Number operator[](std::size_t ray) const { return numbers[ray]; }
  HWY_INLINE hn::Vec<Tag> get(std::size_t v) const { return hn::Load(Tag(), &numbers[v * lanes]); }
  HWY_INLINE void set(std::size_t v, hn::Vec<Tag> vector) { hn::Store(vector, Tag(), &numbers[v * lanes]); }
  HWY_INLINE void set(std::size_t v, hn::Mask<Floats> mask, hn::Vec<Tag> vector) {
    hn::BlendedStore(vector, hn::RebindMask(Tag(), mask), Tag(), &numbers[v * lanes]);
  }
};
using PacketFloats = PacketNumbers<Floats>;
using PacketIndices = PacketNumbers<hn::RebindToUnsigned<Floats>>;
using PacketFloats3 = std::array<PacketFloats, 3>;

HWY_INLINE FloatVec3 vector_of(const PacketFloats3& numbers, std::size_t v) {
  return {numbers[0].get(v), numbers[1].get(v), numbers[2].get(v)};
}
HWY_INLINE FloatVec3 in_all_lanes(const PacketFloats3& numbers, std::size_t ray) {
  const Floats d;
  return {hn::Set(d, numbers[0][ray]), hn::Set(d, numbers[1][ray]), hn::Set(d, numbers[2][ray])};
}

/// Rays made ready to be traced, in floats. All t but those given are for directions scaled by a power
/// of two to a 1-norm of 1..2.
///
/// Why no cell of a brick is missed. The t at which a ray crosses a plane, (low + i * size - origin) /
/// direction, is computed as (low - origin) * inverse + i * (size * inverse): off by no more than some 2^-24
/// of itself and some 2^-24 of what the extent of the brick on that axis is in t. The former is made up for
/// by `slack` wherever the t of planes are compared (as Ize, "Robust BVH Ray Traversal", 2013), the latter by
/// the margin by which bricks and cells are grown before primitives are registered (brick_build.cpp). A
/// direction below 2^-40 on an axis is taken for that: the ray, which starts near the scene, is moved by less
/// than the margin. Neighbouring cells have the plane between them in common, and t grow with the planes'
/// numbers however they are rounded.
struct RayPacket {
  PacketFloats3 origin;
  PacketFloats3 direction;   ///< scaled
  PacketFloats3 inverse;     ///< of that; 2^40 in place of infinity
  PacketFloats scale;        ///< a power of two: scaled t are t * scale
  PacketIndices octant;      ///< the set of axes along which it goes down, bit by bit
  PacketFloats tnear, tfar;  ///< as given
  PacketFloats before, after, inside_from, inside_to;  ///< LaneIntervals

  /// Reads packet_size rays. Returns the ones for which floats do: not those that start far away, or look
  /// behind their origin, or whose direction would leave the range of floats.
  HWY_INLINE PacketMask load(const Ray* rays, const FloatGrid& grid) {
    const Floats d;
    const Integers di;
    const FloatVector least = hn::Set(d, FLT_MIN), most = hn::Set(d, FLT_MAX);
    const FloatVector earlier = hn::Set(d, 1 - 0x1p-20f), later = hn::Set(d, 1 + 0x1p-20f);
    PacketMask taken = 0;
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      // Origin and tnear, direction and tfar in turn: of half the rays each.
      static_assert(sizeof(Ray) == 8 * sizeof(float));
      const float* const numbers = &rays[v * lanes].origin.x;
      FloatVector first[4], second[4], start[4], end[4];
      hn::LoadInterleaved4(d, numbers, first[0], first[1], first[2], first[3]);
      hn::LoadInterleaved4(d, numbers + 4 * lanes, second[0], second[1], second[2], second[3]);
      for (std::size_t i = 0; i < 4; ++i) {
        start[i] = hn::ConcatEven(d, second[i], first[i]);
        end[i] = hn::ConcatOdd(d, second[i], first[i]);
      }

      const FloatVector norm = norm_of({end[0], end[1], end[2]});
      const IntegerVector exponent = hn::And(hn::BitCast(di, norm), hn::Set(di, 0x7f800000));
      const FloatVector power = hn::BitCast(d, exponent),
                        inverse_power = hn::BitCast(d, hn::Sub(hn::Set(di, 0x7f000000), exponent));
      auto sound = hn::And(hn::And(hn::Gt(norm, hn::Set(d, 0x1p-100f)), hn::Lt(norm, hn::Set(d, 0x1p100f))),
                           hn::And(hn::Ge(start[3], hn::Zero(d)), hn::Eq(end[3], end[3])));
      IntegerVector down = hn::Zero(di);
      for (std::size_t a = 0; a < 3; ++a) {
        sound = hn::And(sound, hn::And(hn::Ge(start[a], hn::Set(d, grid.nearby_low[a])),
                                       hn::Le(start[a], hn::Set(d, grid.nearby_high[a]))));
        const FloatVector along = hn::Mul(end[a], inverse_power);
        origin[a].set(v, start[a]);
        direction[a].set(v, along);
        inverse[a].set(
            v, hn::Div(hn::Set(d, 1.0f), hn::CopySign(hn::Max(hn::Abs(along), hn::Set(d, 0x1p-40f)), along)));
        const auto is_down = hn::RebindMask(di, hn::Lt(inverse[a].get(v), hn::Zero(d)));
        down = hn::Or(down, hn::IfThenElseZero(is_down, hn::Set(di, 1 << a)));
      }
      octant.set(v, hn::BitCast(PacketIndices::Tag(), down));
      taken |= packet_bits(bits_of(sound), v);
      scale.set(v, power);
      tnear.set(v, start[3]);
      tfar.set(v, end[3]);
      const auto scaled_up = [&](FloatVector t) {
        return hn::MulAdd(hn::Mul(hn::Max(t, least), power), later, least);
      };
      const auto scaled_down = [&](FloatVector t) {
        return hn::Mul(hn::Mul(hn::Min(t, most), power), earlier);
      };
      before.set(v, scaled_down(start[3]));
      after.set(v, scaled_up(end[3]));
      inside_from.set(v, scaled_up(start[3]));
      inside_to.set(v, scaled_down(end[3]));
    }
    return taken;
  }

  /// The occupied cells of a brick that a ray pierces within its interval. `grown`: by `margin`, all of them.
  template <bool grown = false>
  HWY_INLINE std::uint64_t pierced(std::size_t ray, const BrickNode& node,
                                   [[maybe_unused]] float margin = 0) const {
    const Floats d;
    const PlaneTables& planes = planes_by_octant[octant[ray]];
    // Where it crosses the first plane of an axis, and how far apart the next ones are.
    const auto first = [&](std::size_t a) {
      return hn::Mul(hn::Sub(hn::Set(d, node.low[a]), hn::Set(d, origin[a][ray])),
                     hn::Set(d, inverse[a][ray]));
    };
    const auto step = [&](std::size_t a) {
      return hn::Mul(hn::Set(d, node.size[a]), hn::Set(d, inverse[a][ray]));
    };
    FloatVector in[3] = {first(0), first(1), first(2)}, out[3] = {in[0], in[1], in[2]};
    if constexpr (grown)
      for (std::size_t a = 0; a < 3; ++a) {
        const FloatVector more = hn::Set(d, margin * std::abs(inverse[a][ray]));
        in[a] = hn::Sub(in[a], more);
        out[a] = hn::Add(out[a], more);
      }
    const FloatVector dx = step(0), dy = step(1), dz = step(2);

    FloatVector z_enter[4], z_leave[4];
    for (std::size_t i = 0; i < 4; ++i) {
      z_enter[i] = hn::MulAdd(hn::Set(d, planes.z_enter[i]), dz, in[2]);
      z_leave[i] = hn::MulAdd(hn::Set(d, planes.z_leave[i]), dz, out[2]);
    }
    const FloatVector x_enter = hn::MulAdd(hn::Load(d, planes.x_enter.data()), dx, in[0]);
    const FloatVector x_leave = hn::MulAdd(hn::Load(d, planes.x_leave.data()), dx, out[0]);
    constexpr float slack = 0x1p-20f;
    const FloatVector earlier = hn::Set(d, 1 - slack), later = hn::Set(d, 1 + slack);
    hn::Mask<Floats> layers[4 * widest_vector / lanes];
    for (std::size_t v = 0; v < widest_vector / lanes; ++v) {
      const FloatVector y_enter = hn::MulAdd(hn::Load(d, &planes.y_enter[v * lanes]), dy, in[1]);
      const FloatVector y_leave = hn::MulAdd(hn::Load(d, &planes.y_leave[v * lanes]), dy, out[1]);
      const FloatVector enter = hn::Max(hn::Mul(hn::Max(x_enter, y_enter), earlier), hn::Set(d, before[ray]));
      const FloatVector leave = hn::Min(hn::Mul(hn::Min(x_leave, y_leave), later), hn::Set(d, after[ray]));
      for (std::size_t i = 0; i < 4; ++i)
        layers[i * (widest_vector / lanes) + v] =
            hn::Le(hn::Max(enter, z_enter[i]), hn::Min(leave, z_leave[i]));
    }
#if HWY_TARGET == HWY_AVX3
    // Joined in mask registers: 4 instructions in place of 14.
    const auto cells = _cvtmask64_u64(_mm512_kunpackd(_mm512_kunpackw(layers[3].raw, layers[2].raw),
                                                      _mm512_kunpackw(layers[1].raw, layers[0].raw)));
#else
    std::uint64_t cells = 0;
    for (std::size_t i = 0; i < std::size(layers); ++i) cells |= bits_of(layers[i]) << (lanes * i);
#endif
    return cells & node.occupied;
  }

  HWY_INLINE LaneIntervals intervals(std::size_t v) const {
    return {before.get(v), after.get(v), inside_from.get(v), inside_to.get(v)};
  }
  HWY_INLINE LaneIntervals interval_in_all_lanes(std::size_t ray) const {
    const Floats d;
    return {hn::Set(d, before[ray]), hn::Set(d, after[ray]), hn::Set(d, inside_from[ray]),
            hn::Set(d, inside_to[ray])};
  }

  /// Where the rays are in a box, within their intervals: calls f(v, enter, leave) for each vector.
  template <class F>
  HWY_INLINE void clip(const std::array<float, 3>& low, const std::array<float, 3>& extent, F&& f) const {
    const Floats d;
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      FloatVector enter = hn::Zero(d), leave = hn::Set(d, FLT_MAX);
      for (std::size_t a = 0; a < 3; ++a) {
        const FloatVector by = inverse[a].get(v);
        const FloatVector t0 = hn::Mul(hn::Sub(hn::Set(d, low[a]), origin[a].get(v)), by),
                          t1 = hn::MulAdd(hn::Set(d, extent[a]), by, t0);
        enter = hn::Max(enter, hn::Min(t0, t1));
        leave = hn::Min(leave, hn::Max(t0, t1));
      }
      enter = hn::Max(hn::Mul(enter, hn::Set(d, 1 - 0x1p-20f)), before.get(v));
      leave = hn::Min(hn::Mul(leave, hn::Set(d, 1 + 0x1p-20f)), after.get(v));
      f(v, enter, leave);
    }
  }
  /// The rays that meet a brick's box within their intervals.
  HWY_INLINE PacketMask meet(const BrickNode& node) const {
    PacketMask met = 0;
    clip(node.low, {4 * node.size[0], 4 * node.size[1], 4 * node.size[2]},
         [&](std::size_t v, FloatVector enter, FloatVector leave) {
           met |= packet_bits(bits_of(hn::Le(enter, leave)), v);
         });
    return met;
  }
};

/// A ray whose origin was rounded to floats, by less than a margin on each axis.
struct RoundedRay : RayPacket {
  float margin = 0;

  HWY_INLINE std::uint64_t pierced(std::size_t ray, const BrickNode& node) const {
    return RayPacket::pierced<true>(ray, node, margin);
  }
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
