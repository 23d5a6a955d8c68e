// A ray made ready to step through bricks, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_BRICK_RAY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_RAY_INL
#undef RAYMETER_BRICK_RAY_INL
#else
#define RAYMETER_BRICK_RAY_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "accel/bricks.h"
#include "scenes/geometry/filter.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, widest_vector>;
using FloatVector = hn::Vec<Floats>;
using Bytes = hn::Repartition<std::uint8_t, Floats>;
inline constexpr std::size_t lanes = hn::MaxLanes(Floats());

HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(Floats(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// Where the five planes on each axis lie in sixteen lanes: those of x and those of y together within a
/// vector of eight, those of z where there is room.
inline constexpr std::array<int, 16> lane_axis{0, 0, 0, 0, 0, 2, 2, 2, 1, 1, 1, 1, 1, 2, 2, 2};
alignas(64) inline constexpr std::array<float, 16> lane_plane{0, 1, 2, 3, 4, 0, 1, 2, 0, 1, 2, 3, 4, 3, 4, 4};
inline constexpr std::array<std::size_t, 5> z_lane{5, 6, 7, 13, 14};

constexpr std::array<std::uint8_t, 64> bytes_of_axes() {
  std::array<std::uint8_t, 64> bytes{};
  for (std::size_t i = 0; i < 64; ++i)
    bytes[i] = static_cast<std::uint8_t>(4 * lane_axis[i / 4] + static_cast<int>(i % 4));
  return bytes;
}
alignas(64) inline constexpr std::array<std::uint8_t, 64> axis_bytes = bytes_of_axes();

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

/// All t here are for FilterRay's scaled direction.
///
/// Why no cell is missed. Planes and origin are floats; plane - origin, the inverse of the direction, that
/// with its slack and the product are each off by 2^-24 of themselves, in all by less than `slack`, however
/// far the ray comes from. So the t at which a cell is entered is never computed too late, nor the t at which
/// it is left too early (Ize, "Robust BVH Ray Traversal", 2013). What is flushed to zero, and directions of
/// 0, taken for 2^-127, are paid for by the margin around boxes and cells (brick_build.cpp).
class BrickRay {
 public:
  /// Whether what is said above holds for a ray: not where scaling it would leave the range of floats.
  static bool takes(const FilterRay& ray) {
    return ray.ray.tnear >= 0 && ray.scale > 0x1p-100 && ray.scale < 0x1p100;
  }

  explicit HWY_INLINE BrickRay(const FilterRay& ray) {
    constexpr float slack = 0x1p-21f, largest = 0x1p127f;
    const Floats d;
    const hn::Full128<float> d4;
    const auto one = hn::Set(d4, 1.0f);
    const auto along =
        hn::Mul(hn::LoadU(d4, &ray.ray.direction.x), hn::Set(d4, static_cast<float>(1 / ray.scale)));
    const auto inverse = hn::IfThenElse(hn::Lt(hn::Abs(along), hn::Set(d4, FLT_MIN)), hn::Set(d4, largest),
                                        hn::Div(one, along));
    const auto is_down = hn::Lt(along, hn::Zero(d4));
    alignas(16) std::array<float, 4> enter, leave, down;
    hn::Store(hn::Mul(inverse, hn::Set(d4, 1 - slack)), d4, enter.data());
    hn::Store(hn::Mul(inverse, hn::Set(d4, 1 + slack)), d4, leave.data());
    hn::Store(hn::IfThenElseZero(is_down, hn::Set(d4, 4.0f)), d4, down.data());
    std::uint64_t axes = 0;
    hn::StoreMaskBits(d4, is_down, reinterpret_cast<std::uint8_t*>(&axes));
    axes &= 7u;
    mirror_ = static_cast<unsigned>((axes & 1u) * 3 | (axes & 2u) * 6 | (axes & 4u) * 12);
    tables_ = &mirrors[axes];
    for (std::size_t v = 0; v < vectors; ++v) {
      origin_[v] = by_lane(&ray.ray.origin.x, v);
      enter_[v] = by_lane(enter.data(), v);
      leave_[v] = by_lane(leave.data(), v);
      // Planes are counted from where the ray comes from.
      plane_[v] = hn::Abs(hn::Sub(by_lane(down.data(), v), hn::Load(d, &lane_plane[v * lanes])));
    }
  }

  /// The occupied cells that the ray pierces with tnear <= t <= tmax, in the order in which it meets them:
  /// bit i stands for the cell i ^ mirror().
  HWY_INLINE std::uint64_t pierced(const BrickNode& node, float tnear, float tmax) const {
    const Floats d;
    // Where the ray crosses the planes.
    alignas(64) std::array<float, 16> enters, leaves;
    FloatVector enter[vectors], leave[vectors];
    for (std::size_t v = 0; v < vectors; ++v) {
      const FloatVector plane =
          hn::Add(by_lane(node.low.data(), v), hn::Mul(plane_[v], by_lane(node.size.data(), v)));
      const FloatVector distance = hn::Sub(plane, origin_[v]);
      enter[v] = hn::Mul(distance, enter_[v]);
      leave[v] = hn::Mul(distance, leave_[v]);
      hn::Store(enter[v], d, &enters[v * lanes]);
      hn::Store(leave[v], d, &leaves[v * lanes]);
    }

    // The sixteen columns of cells along z: lane x + 4 y.
    std::uint64_t cells = 0;
    for (std::size_t v = 0; v < vectors; ++v) {
      FloatVector first = hn::Set(d, tnear), last = hn::Set(d, tmax);
      if constexpr (lanes >= 8) {
        constexpr std::size_t y_vector = 8 / lanes, y_lane = 8 % lanes;
        alignas(64) std::int32_t x[lanes], x1[lanes], y[lanes], y1[lanes];
        for (std::size_t i = 0; i < lanes; ++i) {
          x[i] = static_cast<std::int32_t>(i % 4);
          x1[i] = x[i] + 1;
          y[i] = static_cast<std::int32_t>(y_lane + (v * lanes + i) / 4);
          y1[i] = y[i] + 1;
        }
        const auto from = [&](FloatVector vector, const std::int32_t* index) {
          return hn::TableLookupLanes(vector, hn::SetTableIndices(d, index));
        };
        first = hn::Max(first, hn::Max(from(enter[0], x), from(enter[y_vector], y)));
        last = hn::Min(last, hn::Min(from(leave[0], x1), from(leave[y_vector], y1)));
      } else {
        first = hn::Max(first, hn::Max(hn::LoadU(d, &enters[0]), hn::Set(d, enters[8 + v])));
        last = hn::Min(last, hn::Min(hn::LoadU(d, &leaves[1]), hn::Set(d, leaves[9 + v])));
      }
      for (std::size_t z = 0; z < 4; ++z) {
        const auto in = hn::Max(first, hn::Set(d, enters[z_lane[z]]));
        const auto out = hn::Min(last, hn::Set(d, leaves[z_lane[z + 1]]));
        cells |= bits_of(hn::Le(in, out)) << (16 * z + v * lanes);
      }
    }
    return cells & mirrored(node.occupied);
  }

  unsigned mirror() const { return mirror_; }

 private:
  static constexpr std::size_t vectors = widest_vector / lanes;  // that hold sixteen floats

  /// Three numbers by axis as sixteen by lane.
  static HWY_INLINE FloatVector by_lane(const float* by_axis, std::size_t v) {
    const Floats d;
    return hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(Bytes(), hn::LoadDup128(d, by_axis)),
                                               hn::Load(Bytes(), &axis_bytes[4 * v * lanes])));
  }
  HWY_INLINE std::uint64_t mirrored(std::uint64_t mask) const {
    const hn::Full128<std::uint8_t> d8;
    const hn::Full128<std::uint64_t> d64;
    const auto words = hn::Set(d64, mask);
    const auto half = hn::Set(d8, std::uint8_t{15});
    const auto low = hn::And(hn::BitCast(d8, words), half);
    const auto high = hn::And(hn::BitCast(d8, hn::ShiftRight<4>(words)), half);
    const auto rows = hn::Or(hn::TableLookupBytes(hn::Load(d8, tables_->low.data()), low),
                             hn::TableLookupBytes(hn::Load(d8, tables_->high.data()), high));
    return hn::GetLane(hn::BitCast(d64, hn::TableLookupBytes(rows, hn::Load(d8, tables_->byte.data()))));
  }

  FloatVector origin_[vectors], enter_[vectors], leave_[vectors], plane_[vectors];
  const MirrorTables* tables_;
  unsigned mirror_;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
