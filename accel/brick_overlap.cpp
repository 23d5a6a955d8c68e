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
using GroupFloats = hn::Rebind<float, Doubles>;
using GroupFloatVector = hn::Vec<GroupFloats>;
/// As many triangles as a vector has doubles are prepared together.
constexpr std::size_t group = hn::MaxLanes(Doubles());
using Floats = hn::CappedTag<float, widest_vector>;
using FloatVector = hn::Vec<Floats>;
constexpr std::size_t lanes = hn::MaxLanes(Floats());
constexpr float tiny = 1e-30f;

std::uint64_t bits_of(hn::Mask<Floats> mask) {
  std::uint64_t bits = 0;
  hn::StoreMaskBits(Floats(), mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

/// The cells of a brick that triangles meet, by the separating axes of Akenine-Moeller, "Fast 3D Triangle-Box
/// Overlap Testing", 2001: the box's own; the edges' as seen along each of these (a triangle's shadow against
/// 4x4 squares, by edge functions, as in Schwarz & Seidel, "Fast Parallel Surface and Solid Voxelization on
/// GPUs", 2010); and the triangle's plane.
///
/// Everything is in units in which a cell is 1 wide and the brick begins at 0. A cell is grown by
/// - twice its slack: the second time for a relative error of 2^-48 in what is computed in double, which is
///   2^-6 of the margin at most, as no triangle reaches farther than 2^40 of it;
/// - 2^-18: for floats of places less than eight cells away (of boxes), and for coefficients in floats and
///   their sums of two or three products with at most four cells (of edges and planes). `tiny` pays for such
///   as are flushed to zero.
class BrickCells {
 public:
  explicit BrickCells(const CutBrick& brick) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double size = brick.node.size[axis],
                   slack = 2 * brick.slack(static_cast<int>(axis)) / size + 0x1p-18;
      low_[axis] = brick.node.low[axis];
      per_size_[axis] = 1 / size;
      slack_[axis] = static_cast<float>(slack);
      layers_[axis] = static_cast<float>(brick.layers[axis]);
      only_boxes_ |= slack > 1024;
      cells_ &= cells_in_layers[axis][layer_range(0, brick.layers[axis])];
    }
  }

  void find(const TriangleColumns& triangles, std::uint64_t* cells) {
    for (std::size_t first = 0; first < triangles.count; first += lanes) {
      const std::size_t count = std::min(lanes, triangles.count - first);
      const std::uint64_t spread = by_boxes(triangles, first, cells + first) & ((1u << count) - 1);
      if (only_boxes_) continue;
      for (std::size_t i = 0; i < count; i += group) {
        constexpr std::uint64_t all = (1u << group) - 1;
        std::uint64_t rest = spread >> i & all;
        if (rest == 0) continue;
        prepare(triangles, first + i);
        for (; rest != 0; rest &= rest - 1) {
          const auto j = static_cast<std::size_t>(std::countr_zero(rest));
          cells[first + i + j] &= by_shadows(spans_[i + j], j);
        }
      }
    }
  }

 private:
  using Doubles3 = DoubleVector[3];

  /// The cells that a vector of triangles' boxes meet; and, bit by bit, for which of them that is not enough:
  /// in a row that its box lies in, a triangle meets every cell.
  HWY_INLINE std::uint64_t by_boxes(const TriangleColumns& triangles, std::size_t first,
                                    std::uint64_t* cells) {
    const Floats d;
    const hn::RebindToSigned<Floats> ints;
    alignas(64) std::int32_t met[3][lanes];
    auto all_spans = hn::Zero(ints);
    auto axes = hn::Zero(ints);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto at = [&](std::size_t c) {
        return hn::LoadU(d, triangles.rows + (3 * c + axis) * triangles.stride + first);
      };
      const FloatVector a = at(0), b = at(1), c = at(2), low = hn::Set(d, low_[axis]),
                        per_size = hn::Set(d, static_cast<float>(per_size_[axis])),
                        slack = hn::Set(d, slack_[axis]), one = hn::Set(d, 1.0f),
                        beyond = hn::Set(d, layers_[axis] + 1);
      // A layer beyond the brick's at either end stands for all that lies there.
      const auto layer = [&](FloatVector x) {
        return hn::ConvertTo(ints, hn::Min(hn::Max(hn::Add(x, one), hn::Zero(d)), beyond));
      };
      const auto scaled = [&](FloatVector x) { return hn::Mul(hn::Sub(x, low), per_size); };
      const auto first_layer = layer(hn::Sub(scaled(hn::Min(hn::Min(a, b), c)), slack)),
                 last_layer = layer(hn::Add(scaled(hn::Max(hn::Max(a, b), c)), slack));
      hn::Store(hn::Add(hn::ShiftLeft<3>(first_layer), last_layer), ints, met[axis]);
      const auto several = hn::Gt(last_layer, first_layer);
      all_spans = hn::Or(all_spans, hn::IfThenElseZero(several, hn::Set(ints, 1 << axis)));
      axes = hn::Add(axes, hn::IfThenElseZero(several, hn::Set(ints, 1)));
    }
    hn::StoreU(all_spans, ints, spans_);
    for (std::size_t i = 0; i < std::min(lanes, triangles.count - first); ++i)
      cells[i] = cells_ & cells_in_layers[0][static_cast<std::size_t>(met[0][i])] &
                 cells_in_layers[1][static_cast<std::size_t>(met[1][i])] &
                 cells_in_layers[2][static_cast<std::size_t>(met[2][i])];
    return bits_of(hn::RebindMask(d, hn::Gt(axes, hn::Set(ints, 1))));
  }

  /// Makes a group of triangles ready.
  HWY_INLINE void prepare(const TriangleColumns& triangles, std::size_t first) {
    const Doubles d;
    const GroupFloats f;
    Doubles3 at[3], edge[3];
    GroupFloatVector edges[3][3], reach[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const DoubleVector low = hn::Set(d, double(low_[axis])), per_size = hn::Set(d, per_size_[axis]);
      DoubleVector corner[3];
      for (std::size_t c = 0; c < 3; ++c) {
        corner[c] =
            hn::PromoteTo(d, hn::LoadU(f, triangles.rows + (3 * c + axis) * triangles.stride + first));
        at[c][axis] = hn::Mul(hn::Sub(corner[c], low), per_size);
      }
      for (std::size_t c = 0; c < 3; ++c) {
        edge[c][axis] = hn::Mul(hn::Sub(corner[(c + 1) % 3], corner[c]), per_size);
        edges[c][axis] = hn::DemoteTo(f, edge[c][axis]);
      }
      reach[axis] = hn::Set(f, 0.5f + slack_[axis]);
    }

    DoubleVector along = hn::Zero(d);
    GroupFloatVector plane_reach = hn::Set(f, tiny);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      // The normal, whose components are twice the areas of the shadows, and its error.
      const DoubleVector a = hn::Mul(edge[0][i], edge[1][j]), b = hn::Mul(edge[0][j], edge[1][i]),
                         exact_area = hn::Sub(a, b);
      const GroupFloatVector area = hn::DemoteTo(f, exact_area);
      const GroupFloatVector doubt = hn::Add(
          hn::Mul(hn::DemoteTo(f, hn::Add(hn::Abs(a), hn::Abs(b))), hn::Set(f, 0x1p-47f)), hn::Set(f, tiny));

      // Edge functions of the shadow along axis k, positive inside: a square is missed where one is negative
      // on all of it. Where the sign of the area is in doubt, all of the shadow is within that doubt of its
      // edges.
      const GroupFloatVector sign = hn::And(area, hn::SignBit(f)), other_sign = hn::Xor(sign, hn::SignBit(f));
      for (std::size_t c = 0; c < 3; ++c) {
        const GroupFloatVector at_origin =
            hn::DemoteTo(f, hn::Sub(hn::Mul(at[c][i], edge[c][j]), hn::Mul(at[c][j], edge[c][i])));
        const GroupFloatVector ei = edges[c][i], ej = edges[c][j];
        const GroupFloatVector edge_reach =
            hn::Add(hn::Add(hn::Mul(hn::Abs(ei), reach[j]), hn::Mul(hn::Abs(ej), reach[i])), doubt);
        // Columns of squares are along x; seen along x, along y.
        Edge& to = edges_[k][c];
        hn::StoreU(hn::Xor(ej, other_sign), f, k == 1 ? to.by_row : to.by_column);
        hn::StoreU(hn::Xor(ei, sign), f, k == 1 ? to.by_column : to.by_row);
        hn::StoreU(hn::Sub(hn::Xor(at_origin, other_sign), edge_reach), f, to.least);
      }

      along = hn::Add(along, hn::Mul(exact_area, at[0][k]));
      // The normal is not quite perpendicular to the edges.
      const GroupFloatVector askew = hn::Mul(doubt, hn::Add(hn::Abs(edges[0][k]), hn::Abs(edges[1][k])));
      plane_reach = hn::Add(plane_reach, hn::Add(hn::Mul(hn::Abs(area), reach[k]), askew));
      hn::StoreU(area, f, normal_[k]);
    }
    hn::StoreU(hn::Neg(hn::DemoteTo(f, along)), f, plane_at_);
    hn::StoreU(plane_reach, f, plane_reach_);
  }

  /// Of a triangle of the group, whose box spans several layers on the axes of the set `spans`, the cells
  /// that it meets: all of its shadows that spread do. A triangle in one layer is as good as its shadow.
  HWY_INLINE std::uint64_t by_shadows(std::int32_t spans, std::size_t triangle) const {
    switch (spans) {
      case 0b011:
        return along_z(shadow(2, triangle));
      case 0b101:
        return along_y(shadow(1, triangle));
      case 0b110:
        return along_x(shadow(0, triangle));
      default:
        return along_z(shadow(2, triangle)) & along_y(shadow(1, triangle)) & along_x(shadow(0, triangle)) &
               by_plane(triangle);
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
    const FloatVector reach = hn::Set(d, plane_reach_[triangle]);
    std::uint64_t missed = 0;
    for (std::size_t v = 0; v < 16 / lanes; ++v) {
      const FloatVector in_row =
          hn::Add(hn::Mul(row_centres(v), hn::Set(d, normal_[1][triangle])), hn::Set(d, plane_at_[triangle]));
      const FloatVector in_layer =
          hn::Add(in_row, hn::Mul(column_centres(), hn::Set(d, normal_[0][triangle])));
      for (std::size_t z = 0; z < 4; ++z) {
        const FloatVector away =
            hn::Add(in_layer, hn::Set(d, (static_cast<float>(z) + 0.5f) * normal_[2][triangle]));
        missed |= bits_of(hn::Gt(hn::Abs(away), reach)) << (16 * z + v * lanes);
      }
    }
    return ~missed;
  }

  struct Edge {
    float by_column[group], by_row[group], least[group];
  };

  // The brick.
  std::array<float, 3> low_{}, slack_{}, layers_{};
  std::array<double, 3> per_size_{};
  std::uint64_t cells_ = ~std::uint64_t{0};
  bool only_boxes_ = false;    // cells are so small beside the slack that nothing else is worth a test
  std::int32_t spans_[lanes];  // the axes along which a box meets several layers, as a set
  // The group that is ready.
  Edge edges_[3][3];
  float normal_[3][group], plane_at_[group], plane_reach_[group];
};

void cells_of(const CutBrick& brick, const TriangleColumns& triangles, std::uint64_t* cells) {
  BrickCells(brick).find(triangles, cells);
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
