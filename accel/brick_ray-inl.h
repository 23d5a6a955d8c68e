// A ray made ready to step through bricks, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_BRICK_RAY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_RAY_INL
#undef RAYMETER_BRICK_RAY_INL
#else
#define RAYMETER_BRICK_RAY_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "accel/bricks.h"
#include "scenes/geometry/ray.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, widest_vector>;
using FloatVector = hn::Vec<Floats>;
using Integers = hn::RebindToSigned<Floats>;
using IntegerVector = hn::Vec<Integers>;
using Floats4 = hn::Full128<float>;
inline constexpr std::size_t lanes = hn::MaxLanes(Floats());

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(Floats(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// Through which planes a ray enters and leaves the cells of a brick, as numbers to multiply with the size of
/// a cell. Lane x + 4 y stands for a column of cells along z.
struct PlaneTables {
  alignas(64) std::array<float, 16> x_enter{}, x_leave{}, y_enter{}, y_leave{};
  std::array<float, 4> z_enter{}, z_leave{};
};
constexpr std::array<PlaneTables, 8> plane_tables() {
  std::array<PlaneTables, 8> tables{};
  for (unsigned down = 0; down < 8; ++down) {
    PlaneTables& t = tables[down];
    const auto enter = [&](unsigned axis, std::size_t i) {
      return static_cast<float>(down >> axis & 1u ? i + 1 : i);
    };
    const auto leave = [&](unsigned axis, std::size_t i) {
      return static_cast<float>(down >> axis & 1u ? i : i + 1);
    };
    for (std::size_t lane = 0; lane < 16; ++lane) {
      t.x_enter[lane] = enter(0, lane % 4);
      t.x_leave[lane] = leave(0, lane % 4);
      t.y_enter[lane] = enter(1, lane / 4);
      t.y_leave[lane] = leave(1, lane / 4);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      t.z_enter[i] = enter(2, i);
      t.z_leave[i] = leave(2, i);
    }
  }
  return tables;
}
inline constexpr std::array<PlaneTables, 8> planes_by_octant = plane_tables();

/// Tables that reverse a 4x4x4 mask along any axes: what a byte's low and high half become, and where bytes
/// go.
struct MirrorTables {
  alignas(16) std::array<std::uint8_t, 16> low{}, high{}, byte{};
};
constexpr std::array<MirrorTables, 8> mirror_tables() {
  std::array<MirrorTables, 8> tables{};
  for (unsigned axes = 0; axes < 8; ++axes) {
    MirrorTables& t = tables[axes];
    for (unsigned half = 0; half < 16; ++half) {
      unsigned row = half;
      if (axes & 1u) row = (half & 1u) << 3 | (half & 2u) << 1 | (half & 4u) >> 1 | (half & 8u) >> 3;
      t.low[half] = static_cast<std::uint8_t>(axes & 2u ? row << 4 : row);
      t.high[half] = static_cast<std::uint8_t>(axes & 2u ? row : row << 4);
    }
    for (unsigned i = 0; i < 16; ++i)
      t.byte[i] = static_cast<std::uint8_t>((i & 7u) ^ (axes & 2u ? 1u : 0u) ^ (axes & 4u ? 6u : 0u));
  }
  return tables;
}
inline constexpr std::array<MirrorTables, 8> mirrors = mirror_tables();
/// What to xor the number of a cell with, by octant.
inline constexpr std::array<unsigned, 8> mirror_of{0, 3, 12, 15, 48, 51, 60, 63};

/// A mask of cells as a ray of that octant numbers them.
HWY_INLINE std::uint64_t mirrored(std::uint64_t mask, unsigned octant) {
  const hn::Full128<std::uint8_t> d8;
  const hn::Full128<std::uint64_t> d64;
  const MirrorTables& tables = mirrors[octant];
  const auto words = hn::Set(d64, mask);
  const auto half = hn::Set(d8, std::uint8_t{15});
  const auto low = hn::And(hn::BitCast(d8, words), half);
  const auto high = hn::And(hn::BitCast(d8, hn::ShiftRight<4>(words)), half);
  const auto rows = hn::Or(hn::TableLookupBytes(hn::Load(d8, tables.low.data()), low),
                           hn::TableLookupBytes(hn::Load(d8, tables.high.data()), high));
  return hn::GetLane(hn::BitCast(d64, hn::TableLookupBytes(rows, hn::Load(d8, tables.byte.data()))));
}

/// A ray made ready to be traced, in floats. All t here are for its direction scaled by a power of two to a
/// 1-norm of 1..2.
///
/// Why no cell of a brick is missed. The t at which it crosses a plane, (low + i * size - origin) /
/// direction, is computed as (low - origin) * inverse + i * (size * inverse): off by no more than some 2^-24
/// of itself and some 2^-24 of what the extent of the brick on that axis is in t. The former is made up for
/// by `slack` wherever the t of planes are compared (as Ize, "Robust BVH Ray Traversal", 2013), the latter by
/// the margin by which bricks and cells are grown before primitives are registered (brick_build.cpp). A
/// direction below 2^-40 on an axis is taken for that: the ray, which starts near the scene, is moved by less
/// than the margin. Neighbouring cells have the plane between them in common, and t grow with the planes'
/// numbers however they are rounded.
struct BrickRay {
  const Ray* ray = nullptr;          ///< as given
  std::array<float, 3> direction{};  ///< scaled
  std::array<float, 3> inverse{};    ///< of that; 2^40 in place of infinity
  float scale = 1;                   ///< a power of two: t for the scaled direction is t * scale
  unsigned octant = 0;               ///< the set of axes along which it goes down, bit by bit

  /// A t of the given ray as one of the scaled, at least that, or at most: by more than all roundings.
  float scaled_up(float t) const { return std::max(t, FLT_MIN) * scale * (1 + 0x1p-20f) + FLT_MIN; }
  float scaled_down(float t) const { return std::min(t, FLT_MAX) * scale * (1 - 0x1p-20f); }

  /// The occupied cells that the ray pierces with tnear <= t <= tmax.
  HWY_INLINE std::uint64_t pierced(const BrickNode& node, float tnear, float tmax) const {
    const Floats d;
    const PlaneTables& planes = planes_by_octant[octant];
    // Where it crosses the first plane of an axis, and how far apart the next ones are.
    const auto first = [&](std::size_t a, float origin) {
      return hn::Mul(hn::Sub(hn::Set(d, node.low[a]), hn::Set(d, origin)), hn::Set(d, inverse[a]));
    };
    const auto step = [&](std::size_t a) {
      return hn::Mul(hn::Set(d, node.size[a]), hn::Set(d, inverse[a]));
    };
    const FloatVector x = first(0, ray->origin.x), y = first(1, ray->origin.y), z = first(2, ray->origin.z);
    const FloatVector dx = step(0), dy = step(1), dz = step(2);

    FloatVector z_enter[4], z_leave[4];
    for (std::size_t i = 0; i < 4; ++i) {
      z_enter[i] = hn::MulAdd(hn::Set(d, planes.z_enter[i]), dz, z);
      z_leave[i] = hn::MulAdd(hn::Set(d, planes.z_leave[i]), dz, z);
    }
    const FloatVector x_enter = hn::MulAdd(hn::Load(d, planes.x_enter.data()), dx, x);
    const FloatVector x_leave = hn::MulAdd(hn::Load(d, planes.x_leave.data()), dx, x);
    constexpr float slack = 0x1p-20f;
    const FloatVector earlier = hn::Set(d, 1 - slack), later = hn::Set(d, 1 + slack);
    hn::Mask<Floats> layers[4 * widest_vector / lanes];
    for (std::size_t v = 0; v < widest_vector / lanes; ++v) {
      const FloatVector y_enter = hn::MulAdd(hn::Load(d, &planes.y_enter[v * lanes]), dy, y);
      const FloatVector y_leave = hn::MulAdd(hn::Load(d, &planes.y_leave[v * lanes]), dy, y);
      const FloatVector enter = hn::Max(hn::Mul(hn::Max(x_enter, y_enter), earlier), hn::Set(d, tnear));
      const FloatVector leave = hn::Min(hn::Mul(hn::Min(x_leave, y_leave), later), hn::Set(d, tmax));
      for (std::size_t i = 0; i < 4; ++i)
        layers[i * (widest_vector / lanes) + v] =
            hn::Le(hn::Max(enter, z_enter[i]), hn::Min(leave, z_leave[i]));
    }
#if HWY_TARGET == HWY_AVX3
    // Of masks in registers of their own.
    const auto cells = _cvtmask64_u64(_mm512_kunpackd(_mm512_kunpackw(layers[3].raw, layers[2].raw),
                                                      _mm512_kunpackw(layers[1].raw, layers[0].raw)));
#else
    std::uint64_t cells = 0;
    for (std::size_t i = 0; i < std::size(layers); ++i) cells |= bits_of(layers[i]) << (lanes * i);
#endif
    return cells & node.occupied;
  }
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
