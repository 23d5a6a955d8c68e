#include "accel/brick_overlap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/brick_overlap.cpp"  // this file, compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "accel/cell_overlap.h"

#ifndef RAYMETER_BRICK_OVERLAP_ONCE
#define RAYMETER_BRICK_OVERLAP_ONCE
namespace raymeter {
namespace {

/// By axis, the cells in layers first .. end - 1, where -1 <= first and end <= 5, at layer_range(first, end).
using LayerMasks = std::array<std::array<std::uint64_t, 48>, 3>;
constexpr std::size_t layer_range(int first, int end) {
  return static_cast<std::size_t>(8 * (first + 1) + end);
}
constexpr LayerMasks layer_masks() {
  LayerMasks masks{};
  for (int cell = 0; cell < 64; ++cell) {
    const std::array<int, 3> at{cell % 4, cell / 4 % 4, cell / 16};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int first = -1; first <= at[axis]; ++first)
        for (int end = at[axis] + 1; end <= 5; ++end)
          masks[axis][layer_range(first, end)] |= std::uint64_t{1} << cell;
  }
  return masks;
}
constexpr LayerMasks cells_in_layers = layer_masks();

/// Of a set of lines of cells along an axis, seen along it, the cells: bits x + 4 y, y + 4 z and x + 4 z.
inline std::uint64_t along_z(std::uint64_t xy) {
  return xy * 0x0001000100010001u;
}
inline std::uint64_t along_x(std::uint64_t yz) {
  std::uint64_t bits = (yz | yz << 24) & 0x000000ff000000ffu;
  bits = (bits | bits << 12) & 0x000f000f000f000fu;
  bits = (bits | bits << 6) & 0x0303030303030303u;
  bits = (bits | bits << 3) & 0x1111111111111111u;
  return bits * 15;
}
inline std::uint64_t along_y(std::uint64_t xz) {
  return ((xz & 0xfu) | (xz & 0xf0u) << 12 | (xz & 0xf00u) << 24 | (xz & 0xf000u) << 36) * 0x1111u;
}

}  // namespace
}  // namespace raymeter
#endif

#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using DoubleVector = hn::Vec<Doubles>;
/// As many triangles as a vector has doubles are prepared together.
constexpr std::size_t group = hn::MaxLanes(Doubles());
using Floats = hn::CappedTag<float, widest_vector>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = hn::MaxLanes(Floats());

struct Doubles3 {
  DoubleVector v[3];
  DoubleVector& operator[](std::size_t axis) { return v[axis]; }
  const DoubleVector& operator[](std::size_t axis) const { return v[axis]; }
};

std::uint64_t bits_of(hn::Mask<Floats> mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(Floats(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// A group of triangles made ready for the separating axes of Akenine-Moeller, "Fast 3D Triangle-Box Overlap
/// Testing", 2001: the box's own, the edges' as seen along each of these (a triangle's shadow against 4x4
/// squares, by edge functions, as in Schwarz & Seidel, "Fast Parallel Surface and Solid Voxelization on
/// GPUs", 2010), and the triangle's plane.
///
/// Everything is in units in which a cell is 1 wide and the brick begins at 0, in double until what is small
/// has been subtracted. A cell's half width on each axis, grown by its slack in these units, is `reach`. Of
/// the slack, the roundings of a plane take one part; it is twice that, so that the other pays for
/// - a relative error of 2^-48 in corners and edges, which their coordinates limit to 2^-6 of the margin;
/// - what is added to it, 2^-18 of a cell, for the floats in the end: coefficients, and sums of two or three
///   products with at most four cells. `tiny` pays for such as are flushed to zero.
class Group {
 public:
  explicit Group(const CutBrick& brick) {
    const Doubles d;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double size = brick.node.size[axis];
      const double slack = 2 * brick.slack(static_cast<int>(axis)) / size;
      low_[axis] = hn::Set(d, double(brick.node.low[axis]));
      per_size_[axis] = hn::Set(d, 1 / size);
      slack_[axis] = hn::Set(d, slack + 0x1p-18);
      reach_[axis] = hn::Set(d, 0.5 + slack + 0x1p-18);
      layers_[axis] = hn::Set(d, double(brick.layers[axis]));
      only_boxes_ |= slack > 1024;
      cells_ &= cells_in_layers[axis][layer_range(0, brick.layers[axis])];
    }
  }

  HWY_INLINE void prepare(const TriangleColumns& triangles, std::size_t first) {
    const Doubles d;
    const hn::Rebind<float, Doubles> floats;
    Doubles3 corner[3], at[3], edge[3];
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corner[c][axis] =
            hn::PromoteTo(d, hn::LoadU(floats, triangles.rows + (3 * c + axis) * triangles.stride + first));
        at[c][axis] = hn::Mul(hn::Sub(corner[c][axis], low_[axis]), per_size_[axis]);
      }
    set_box(at);
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t axis = 0; axis < 3; ++axis)
        edge[c][axis] = hn::Mul(hn::Sub(corner[(c + 1) % 3][axis], corner[c][axis]), per_size_[axis]);

    // The normal, whose components are twice the areas of the shadows, and their errors.
    Doubles3 normal, doubt;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const DoubleVector a = hn::Mul(edge[0][i], edge[1][j]), b = hn::Mul(edge[0][j], edge[1][i]);
      normal[k] = hn::Sub(a, b);
      doubt[k] = hn::Add(hn::Mul(hn::Add(hn::Abs(a), hn::Abs(b)), hn::Set(d, 0x1p-47)), hn::Set(d, tiny));
    }
    for (std::size_t k = 0; k < 3; ++k) set_edges(k, at, edge, normal[k], doubt[k]);

    DoubleVector along = hn::Zero(d), reach = hn::Set(d, tiny);
    for (std::size_t k = 0; k < 3; ++k) {
      along = hn::Add(along, hn::Mul(normal[k], at[0][k]));
      reach = hn::Add(reach, hn::Mul(hn::Abs(normal[k]), reach_[k]));
      // The normal is not quite perpendicular to the edges.
      reach = hn::Add(reach, hn::Mul(doubt[k], hn::Add(hn::Abs(edge[0][k]), hn::Abs(edge[1][k]))));
      store(normal[k], normal_[k]);
    }
    store(hn::Sub(along, reach), nearest_);
    store(hn::Add(along, reach), farthest_);
  }

  /// The cells that triangle i of the group meets.
  HWY_INLINE std::uint64_t cells_of(std::size_t i) const {
    const std::uint64_t box = cells_ & cells_in_layers[0][static_cast<std::size_t>(layers_met_[0][i])] &
                              cells_in_layers[1][static_cast<std::size_t>(layers_met_[1][i])] &
                              cells_in_layers[2][static_cast<std::size_t>(layers_met_[2][i])];
    // In a row that its box lies in, a triangle meets every cell; in a layer, those that its shadow meets.
    switch (only_boxes_ ? 0 : spans_[i]) {
      case 0b011:
        return box & along_z(shadow(2, i));
      case 0b101:
        return box & along_y(shadow(1, i));
      case 0b110:
        return box & along_x(shadow(0, i));
      case 0b111:
        return box & along_z(shadow(2, i)) & along_y(shadow(1, i)) & along_x(shadow(0, i)) & by_plane(i);
      default:
        return box;
    }
  }

 private:
  using Numbers = float[group];
  static constexpr double tiny = 1e-30;

  static HWY_INLINE void store(DoubleVector from, Numbers& to) {
    const hn::Rebind<float, Doubles> floats;
    hn::StoreU(hn::DemoteTo(floats, from), floats, to);
  }

  HWY_INLINE void set_box(const Doubles3 (&at)[3]) {
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> ints;
    auto spans = hn::Zero(ints);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const DoubleVector low = hn::Min(hn::Min(at[0][axis], at[1][axis]), at[2][axis]);
      const DoubleVector high = hn::Max(hn::Max(at[0][axis], at[1][axis]), at[2][axis]);
      // A layer beyond the brick's at either end stands for all that lies there.
      const auto layer = [&](DoubleVector x) {
        const auto beyond = hn::Add(layers_[axis], hn::Set(d, 1.0));
        return hn::DemoteTo(ints, hn::Min(hn::Max(hn::Add(x, hn::Set(d, 1.0)), hn::Zero(d)), beyond));
      };
      const auto first = layer(hn::Sub(low, slack_[axis])), last = layer(hn::Add(high, slack_[axis]));
      hn::StoreU(hn::Add(hn::ShiftLeft<3>(first), last), ints, layers_met_[axis]);
      const auto several = hn::Gt(last, first);
      spans = hn::Or(spans, hn::IfThenElseZero(several, hn::Set(ints, 1 << axis)));
    }
    hn::StoreU(spans, ints, spans_);
  }

  /// The edge functions of the shadow along axis k: positive inside. A square is missed where one is negative
  /// on all of it.
  HWY_INLINE void set_edges(std::size_t k, const Doubles3 (&at)[3], const Doubles3 (&edge)[3],
                            DoubleVector area, DoubleVector doubt) {
    const Doubles d;
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const DoubleVector sign = hn::And(area, hn::SignBit(d));
    for (std::size_t c = 0; c < 3; ++c) {
      const DoubleVector ei = edge[c][i], ej = edge[c][j];
      const DoubleVector at_origin = hn::Sub(hn::Mul(at[c][i], ej), hn::Mul(at[c][j], ei));
      // Where the sign is in doubt, the shadow is so thin that all of it is within `doubt` of its edges.
      const DoubleVector reach =
          hn::Add(hn::Add(hn::Mul(hn::Abs(ei), reach_[j]), hn::Mul(hn::Abs(ej), reach_[i])), doubt);
      const DoubleVector by_i = hn::Xor(hn::Neg(ej), sign), by_j = hn::Xor(ei, sign);
      store(k == 1 ? by_j : by_i, edges_[k][c].by_column);  // x, y, x
      store(k == 1 ? by_i : by_j, edges_[k][c].by_row);     // z, z, y
      store(hn::Neg(hn::Add(hn::Xor(at_origin, sign), reach)), edges_[k][c].least);
    }
  }

  static HWY_INLINE FloatVector column_centres() {
    const Floats d;
    alignas(64) static constexpr std::array<float, 16> at{0.5, 1.5, 2.5, 3.5, 0.5, 1.5, 2.5, 3.5,
                                                          0.5, 1.5, 2.5, 3.5, 0.5, 1.5, 2.5, 3.5};
    return hn::Load(d, at.data());
  }
  static HWY_INLINE FloatVector row_centres(std::size_t vector) {
    const Floats d;
    alignas(64) static constexpr std::array<float, 16> at{0.5, 0.5, 0.5, 0.5, 1.5, 1.5, 1.5, 1.5,
                                                          2.5, 2.5, 2.5, 2.5, 3.5, 3.5, 3.5, 3.5};
    return hn::Load(d, &at[vector * lanes]);
  }

  /// The squares, bit column + 4 row, that the triangle's shadow along axis k meets.
  HWY_INLINE std::uint64_t shadow(std::size_t k, std::size_t triangle) const {
    const Floats d;
    std::uint64_t missed = 0;
    for (std::size_t v = 0; v < 16 / lanes; ++v) {
      const auto misses = [&](const Edge& edge) {
        const FloatVector value = hn::Add(hn::Mul(column_centres(), hn::Set(d, edge.by_column[triangle])),
                                          hn::Mul(row_centres(v), hn::Set(d, edge.by_row[triangle])));
        return hn::Lt(value, hn::Set(d, edge.least[triangle]));
      };
      const auto& edges = edges_[k];
      missed |= bits_of(hn::Or(hn::Or(misses(edges[0]), misses(edges[1])), misses(edges[2]))) << (v * lanes);
    }
    return missed ^ 0xffffu;
  }

  /// The cells that the triangle's plane meets.
  HWY_INLINE std::uint64_t by_plane(std::size_t triangle) const {
    const Floats d;
    const FloatVector nearest = hn::Set(d, nearest_[triangle]), farthest = hn::Set(d, farthest_[triangle]);
    std::uint64_t missed = 0;
    for (std::size_t v = 0; v < 16 / lanes; ++v) {
      const FloatVector in_layer = hn::Add(hn::Mul(column_centres(), hn::Set(d, normal_[0][triangle])),
                                           hn::Mul(row_centres(v), hn::Set(d, normal_[1][triangle])));
      for (std::size_t z = 0; z < 4; ++z) {
        const FloatVector value =
            hn::Add(in_layer, hn::Set(d, (static_cast<float>(z) + 0.5f) * normal_[2][triangle]));
        missed |= bits_of(hn::Or(hn::Lt(value, nearest), hn::Gt(value, farthest))) << (16 * z + v * lanes);
      }
    }
    return ~missed;
  }

  struct Edge {
    Numbers by_column, by_row, least;
  };
  Doubles3 low_, per_size_, slack_, reach_, layers_;
  std::uint64_t cells_ = ~std::uint64_t{0};  // of the brick
  bool only_boxes_ = false;  // cells are so small beside the slack that nothing else is worth a test
  Edge edges_[3][3];
  Numbers normal_[3], nearest_, farthest_;
  std::int32_t layers_met_[3][group], spans_[group];
};

void cells_of(const CutBrick& brick, const TriangleColumns& triangles, std::uint64_t* cells) {
  Group prepared(brick);
  for (std::size_t first = 0; first < triangles.count; first += group) {
    prepared.prepare(triangles, first);
    const std::size_t count = std::min(group, triangles.count - first);
    for (std::size_t i = 0; i < count; ++i) cells[first + i] = prepared.cells_of(i);
  }
}

Bounds bounds_of(const TriangleColumns& triangles) {
  const Floats d;
  Bounds box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    FloatVector low = hn::Set(d, triangles.rows[axis * triangles.stride]), high = low;
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const row = triangles.rows + (3 * c + axis) * triangles.stride;
      for (std::size_t i = 0; i < triangles.count; i += lanes) {
        const auto there = hn::FirstN(d, triangles.count - i);
        const FloatVector x = hn::IfThenElse(there, hn::LoadU(d, row + i), hn::Set(d, row[i]));
        low = hn::Min(low, x);
        high = hn::Max(high, x);
      }
    }
    box.low[static_cast<int>(axis)] = hn::GetLane(hn::MinOfLanes(d, low));
    box.high[static_cast<int>(axis)] = hn::GetLane(hn::MaxOfLanes(d, high));
  }
  return box;
}

void count_bits(std::span<const std::uint64_t> masks, std::array<std::uint32_t, 64>& counts) {
  const hn::CappedTag<std::uint8_t, 64> d;
  constexpr std::size_t bytes = hn::MaxLanes(d), vectors = 64 / bytes;
  constexpr std::size_t most = 255;  // that a byte can count
  for (std::size_t first = 0; first < masks.size(); first += most) {
    hn::Vec<decltype(d)> sums[vectors];
    for (auto& sum : sums) sum = hn::Zero(d);
    for (const std::uint64_t& mask : masks.subspan(first, std::min(most, masks.size() - first)))
      for (std::size_t v = 0; v < vectors; ++v) {
        const auto bits = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&mask) + v * bytes / 8);
        sums[v] = hn::Sub(sums[v], hn::VecFromMask(d, bits));
      }
    alignas(64) std::array<std::uint8_t, 64> parts;
    for (std::size_t v = 0; v < vectors; ++v) hn::Store(sums[v], d, &parts[v * bytes]);
    for (std::size_t i = 0; i < 64; ++i) counts[i] += parts[i];
  }
}

}  // namespace

BrickOverlap target_overlap() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse4.2";
  return {isa, bounds_of, cells_of, count_bits};
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace raymeter {

std::span<const BrickOverlap> brick_overlaps() {
  static const std::vector<BrickOverlap> overlaps = [] {
    std::vector<BrickOverlap> all;
#if HWY_ARCH_X86
    const auto supported = hwy::SupportedTargets();
    if (supported & HWY_AVX3) all.push_back(N_AVX3::target_overlap());
    if (supported & HWY_AVX2) all.push_back(N_AVX2::target_overlap());
    if (supported & HWY_SSE4) all.push_back(N_SSE4::target_overlap());
#endif
    return all;
  }();
  return overlaps;
}

std::uint64_t cells_of_other(const CutBrick& brick, const Scene& scene, std::uint32_t primitive) {
  const Bounds box = scene.bounds_of(primitive);
  Vec3d low, half;
  double slack = 0;
  std::uint64_t cells = ~std::uint64_t{0};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    low[axis] = brick.node.low[a];
    half[axis] = 0.5 * brick.node.size[a];
    const double reach = brick.slack(axis);
    slack = std::max(slack, reach);
    int first = 0, end = brick.layers[a];
    while (first < end && brick.node.plane(axis, first + 1) < box.low[axis] - reach) ++first;
    while (first < end && brick.node.plane(axis, end - 1) > box.high[axis] + reach) --end;
    cells &= cells_in_layers[a][layer_range(first, end)];
  }
  if ((cells & (cells - 1)) == 0) return cells;
  return with_overlap(scene, primitive, half, slack, [&](const auto& overlap) {
    std::uint64_t met = 0;
    for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1) {
      const auto cell = static_cast<unsigned>(std::countr_zero(rest));
      const unsigned x = cell % 4, y = cell / 4 % 4, z = cell / 16;
      const Vec3d centre = low + Vec3d{(2 * x + 1) * half.x, (2 * y + 1) * half.y, (2 * z + 1) * half.z};
      if (overlap.meets(centre)) met |= std::uint64_t{1} << cell;
    }
    return met;
  });
}

}  // namespace raymeter
#endif
