// The vectors of kernels and the 64 cells of a brick, for the instruction set of HWY_TARGET: included once
// for each.
#if defined(RAYMETER_BRICK_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_CELLS_INL
#undef RAYMETER_BRICK_CELLS_INL
#else
#define RAYMETER_BRICK_CELLS_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "accel/bricks.h"

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

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
