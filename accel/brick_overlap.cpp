#include "accel/brick_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "accel/cell_overlap.h"

namespace raymeter {
namespace {

/// A row of bits, each as wide as four: bit i of a nibble becomes nibble i.
constexpr std::array<std::uint16_t, 16> widened_nibbles() {
  std::array<std::uint16_t, 16> table{};
  for (unsigned bits = 0; bits < 16; ++bits)
    for (unsigned i = 0; i < 4; ++i)
      if (bits >> i & 1u) table[bits] = static_cast<std::uint16_t>(table[bits] | 0xfu << (4 * i));
  return table;
}
constexpr std::array<std::uint16_t, 16> widened = widened_nibbles();
constexpr std::uint64_t each_layer = 0x0001000100010001u, each_row = 0x1111111111111111u;

/// Masks of the cells whose layers on an axis are in a set of four bits.
std::uint64_t on_x(unsigned layers) {
  return layers * each_row;
}
std::uint64_t on_y(unsigned layers) {
  return widened[layers] * each_layer;
}
std::uint64_t on_z(unsigned layers) {
  std::uint64_t cells = 0;
  for (unsigned z = 0; z < 4; ++z)
    if (layers >> z & 1u) cells |= std::uint64_t{0xffff} << (16 * z);
  return cells;
}

/// Where along an axis the centre of a cell must lie, from the brick's centre, if the cell is to meet a
/// triangle. In units in which the brick is about 4 wide along the axis, whatever the sizes: floats then
/// neither overflow nor are flushed, and `rounding` pays for theirs.
struct Slab {
  float low, high;
  double per_unit;

  /// `reach`: how far a cell reaches from its centre; low and high: how far the triangle does.
  Slab(double reach, double from, double to) : per_unit(1 / reach) {
    constexpr double rounding = 0x1p-18, beyond = 64;  // no cell's centre is farther than 4 reaches
    low = static_cast<float>(std::clamp((from - reach) * per_unit - rounding, -beyond, beyond));
    high = static_cast<float>(std::clamp((to + reach) * per_unit + rounding, -beyond, beyond));
  }
  /// False of an axis without length.
  bool separates() const { return per_unit < std::numeric_limits<double>::infinity(); }
  std::array<float, 4> of(double n, const std::array<double, 4>& middle) const {
    std::array<float, 4> along;
    for (std::size_t k = 0; k < 4; ++k) along[k] = static_cast<float>(n * middle[k] * per_unit);
    return along;
  }
};

}  // namespace

BrickOverlap::BrickOverlap(const BrickNode& brick, const std::array<int, 3>& layers, double margin,
                           SumsWithin sums_within)
    : layers_(layers), margin_(margin), sums_within_(sums_within) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (int i = 0; i <= 4; ++i) plane_[a][static_cast<std::size_t>(i)] = brick.plane(axis, i);
    const double low = plane_[a][0], high = plane_[a][static_cast<std::size_t>(layers[a])];
    centre_[axis] = 0.5 * (low + high);
    half_[axis] = 0.5 * brick.size[a];
    // See BrickRay.
    margin_ = std::max(margin_, 0x1p-20 * (high - low));
    for (int i = 0; i < 4; ++i)
      middle_[a][static_cast<std::size_t>(i)] = low + (i + 0.5) * double(brick.size[a]) - centre_[axis];
  }
}

std::uint64_t BrickOverlap::cells_of(const Scene& scene, std::uint32_t primitive) const {
  const std::uint64_t cells = cells_of(scene.bounds_of(primitive));
  if ((cells & (cells - 1)) == 0) return cells;
  if (scene.is_triangle(primitive)) return cells & cells_of(scene.triangle(primitive));
  return with_overlap(scene, primitive, half_, margin_, [&](const auto& overlap) {
    std::uint64_t met = 0;
    for (std::uint64_t rest = cells; rest != 0; rest &= rest - 1) {
      const auto cell = static_cast<unsigned>(std::countr_zero(rest));
      const Vec3d centre =
          centre_ + Vec3d{middle_[0][cell % 4], middle_[1][cell / 4 % 4], middle_[2][cell / 16]};
      if (overlap.meets(centre)) met |= std::uint64_t{1} << cell;
    }
    return met;
  });
}

std::uint64_t BrickOverlap::cells_of(const Bounds& box) const {
  std::array<unsigned, 3> layers{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double low = box.low[axis] - margin_, high = box.high[axis] + margin_;
    for (int i = 0; i < layers_[a]; ++i) {
      const auto at = static_cast<std::size_t>(i);
      layers[a] |= unsigned(plane_[a][at] <= high && plane_[a][at + 1] >= low) << i;
    }
  }
  return on_x(layers[0]) & on_y(layers[1]) & on_z(layers[2]);
}

/// By separating axes: the triangle's plane, and its edges seen along each axis (Akenine-Moeller 2001; the
/// latter as Schwarz & Seidel, "Fast Parallel Surface and Solid Voxelization on GPUs", 2010, in three planes
/// of sixteen cells each).
std::uint64_t BrickOverlap::cells_of(const Triangle& triangle) const {
  // Relative to the brick's centre, in double until what is small has been subtracted.
  const Vec3d a = to_double(triangle.a) - centre_, b = to_double(triangle.b) - centre_,
              c = to_double(triangle.c) - centre_;
  const Vec3d e1 = b - a, e2 = c - a, e3 = c - b;
  const Vec3d reach = half_ + Vec3d{margin_, margin_, margin_};

  std::uint64_t cells = ~std::uint64_t{0};
  const auto edge = [&](const Vec3d& e, int i, int j, unsigned& within) {
    const double ni = -e[j], nj = e[i];
    const double pa = ni * a[i] + nj * a[j], pb = ni * b[i] + nj * b[j], pc = ni * c[i] + nj * c[j];
    const Slab slab(std::abs(ni) * reach[i] + std::abs(nj) * reach[j], std::min({pa, pb, pc}),
                    std::max({pa, pb, pc}));
    if (!slab.separates()) return;
    within &= sums_within_(slab.of(ni, middle_[static_cast<std::size_t>(i)]),
                           slab.of(nj, middle_[static_cast<std::size_t>(j)]), slab.low, slab.high);
  };
  unsigned xy = 0xffff, xz = 0xffff, yz = 0xffff;
  for (const Vec3d& e : {e1, e2, e3}) {
    edge(e, 0, 1, xy);
    edge(e, 0, 2, xz);
    edge(e, 1, 2, yz);
  }
  cells &= xy * each_layer;
  std::uint64_t by_xz = 0, by_yz = 0;
  for (unsigned z = 0; z < 4; ++z) {
    by_xz |= ((xz >> (4 * z) & 0xfu) * std::uint64_t{0x1111}) << (16 * z);
    by_yz |= std::uint64_t{widened[yz >> (4 * z) & 0xfu]} << (16 * z);
  }
  cells &= by_xz & by_yz;

  const Vec3d n = cross(e1, e2);
  // The rounded normal is not quite perpendicular to the edges.
  const double at_a = dot(n, a), at_b = dot(n, b), at_c = dot(n, c);
  const Slab slab(std::abs(n.x) * reach.x + std::abs(n.y) * reach.y + std::abs(n.z) * reach.z,
                  std::min({at_a, at_b, at_c}), std::max({at_a, at_b, at_c}));
  if (!slab.separates()) return cells;
  const auto along_x = slab.of(n.x, middle_[0]), along_y = slab.of(n.y, middle_[1]),
             along_z = slab.of(n.z, middle_[2]);
  for (unsigned z = 0; z < 4; ++z) {
    const std::uint64_t layer = sums_within_(along_x, along_y, slab.low - along_z[z], slab.high - along_z[z]);
    cells &= ~(std::uint64_t{0xffff} << (16 * z)) | layer << (16 * z);
  }
  return cells;
}

}  // namespace raymeter
