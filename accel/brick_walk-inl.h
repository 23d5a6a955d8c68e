// The walk of rays through the grid of roots, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_BRICK_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_WALK_INL
#undef RAYMETER_BRICK_WALK_INL
#else
#define RAYMETER_BRICK_WALK_INL
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "accel/probe.h"
#include "accel/ray_packet-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// As many independent rays as a vector has lanes, taken from cell to cell in step: this is alike for all.
/// What is below a root is then done ray by ray.
///
/// A 3DDDA as in grid_walk.h, in floats. Why no cell is missed: an axis' planes are crossed at first + index
/// * delta, which grows with the index however it is rounded, and at any t the walk is in the layer between
/// the two planes whose t enclose it. So its place is wrong by no more than what the rounding of a t means in
/// space: less than 2^-18 of the diagonal, for rays that start within four diagonals. Primitives are
/// registered in every cell that they come as near to as the margin of Bricks::space, which is more, by what
/// the origin of a RoundedRay is off, too.
class BrickWalk {
 public:
  /// Of cells where there is nothing.
  static constexpr std::uint32_t no_root = 0xffffffffu;

  /// The rays that `which` has of vector v of the packet, which RayPacket::load says floats do for. `roots`:
  /// by cell, whatever they number; no_root where there is none. `boxes`: of the roots, by cell, or null.
  HWY_INLINE BrickWalk(const FloatGrid& grid, const std::uint32_t* roots, const RootBox* boxes,
                       const RayPacket& rays, std::size_t v, std::uint64_t which)
      : roots_(reinterpret_cast<const std::int32_t*>(roots)),
        boxes_(reinterpret_cast<const std::int32_t*>(boxes)),
        cell_reach_(grid.cell_reach),
        before_(rays.before.get(v)) {
    const Floats d;
    const Integers di;
    const FloatVector zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    FloatVector enter = before_, leave = rays.after.get(v), from_origin[3];
    for (std::size_t a = 0; a < 3; ++a) {
      // The part inside the box.
      const FloatVector inverse = rays.inverse[a].get(v);
      from_origin[a] = hn::Sub(hn::Set(d, grid.low[a]), rays.origin[a].get(v));
      first_[a] = hn::Mul(from_origin[a], inverse);
      delta_[a] = hn::Mul(hn::Set(d, grid.size[a]), inverse);
      const FloatVector last = hn::MulAdd(hn::Set(d, grid.layers[a]), delta_[a], first_[a]);
      enter = hn::Max(enter, hn::Min(first_[a], last));
      leave = hn::Min(leave, hn::Max(first_[a], last));
    }
    FloatVector plane[3];
    cell_ = hn::Zero(di);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto is_up = hn::Gt(rays.inverse[a].get(v), zero);
      const FloatVector place = hn::Mul(hn::MulSub(rays.direction[a].get(v), enter, from_origin[a]),
                                        hn::Set(d, grid.inverse_size[a]));
      const FloatVector layer = hn::Floor(hn::Min(hn::Max(place, zero), hn::Set(d, grid.layers[a] - 1)));
      const IntegerVector stride = hn::Set(di, grid.stride[a]);
      cell_ = hn::Add(cell_, hn::Mul(hn::ConvertTo(di, layer), stride));
      // The planes ahead. The last of them is crossed at `leave`, or after.
      plane[a] = hn::IfThenElse(is_up, hn::Add(layer, one), layer);
      step_[a] = hn::IfThenElse(is_up, one, hn::Neg(one));
      stride_[a] = hn::IfThenElse(hn::RebindMask(di, is_up), stride, hn::Neg(stride));
    }
    x_ = plane[0];
    y_ = plane[1];
    z_ = plane[2];
    hn::Store(leave, d, end_.data());
    walking_ = hn::And(mask_of(which), hn::Le(enter, leave));
  }

  /// Takes all rays on to the next cell, in step, until one or more stand in a cell whose root they meet, or
  /// all are out; the first time from where they begin. Returns the set of those that do.
  template <class Probe>
  HWY_INLINE std::uint64_t next_roots(Probe& probe) {
    const Integers di;
    const Floats d;
    // In registers, which g++ does not do for structures.
    FloatVector x = x_, y = y_, z = z_;
    IntegerVector cell = cell_, root = hn::Zero(di);
    auto walking = walking_, found = hn::FirstN(d, 0);
    if (begun_) advance(x, y, z, cell, walking);
    begun_ = true;
    while (!hn::AllFalse(d, walking)) {
      root = hn::GatherIndex(di, roots_, cell);
      const auto at_root = hn::AndNot(
          hn::RebindMask(d, hn::Eq(root, hn::Set(di, static_cast<std::int32_t>(no_root)))), walking);
      found = at_root;
      if (boxes_ != nullptr && !hn::AllFalse(d, at_root)) found = hn::And(at_root, meets_root(x, y, z, cell));
      if constexpr (!std::is_same_v<Probe, NoProbe>) {
        for (auto i = hn::CountTrue(d, hn::AndNot(at_root, walking)); i > 0; --i) probe.cell_step(true);
        for (auto i = hn::CountTrue(d, hn::AndNot(found, at_root)); i > 0; --i) probe.inner_step();
      }
      if (!hn::AllFalse(d, found)) break;
      advance(x, y, z, cell, walking);
    }
    x_ = x;
    y_ = y;
    z_ = z;
    cell_ = cell;
    walking_ = walking;
    hn::Store(root, di, root_of_.data());
    // No point of the cell is farther from the origin than where the ray leaves it, and a cell's size.
    const FloatVector leave = hn::Min(hn::Min(next(x, 0), next(y, 1)), next(z, 2));
    hn::Store(hn::MulAdd(leave, hn::Set(d, 2 * (1 + 0x1p-15f)), hn::Set(d, cell_reach_)), d,
              reach_of_.data());
    return bits_of(found);
  }
  /// Of the present cell.
  std::uint32_t root(std::size_t lane) const { return static_cast<std::uint32_t>(root_of_[lane]); }
  /// An upper bound of the 1-norm from the ray's origin to any point of the present cell or a margin around.
  float reach(std::size_t lane) const { return reach_of_[lane]; }

  /// Nothing matters to that ray beyond tmax.
  void end(std::size_t lane, float tmax) { end_[lane] = std::min(end_[lane], tmax); }

 private:
  /// Whether the box of the present cell's root lies on the way.
  HWY_INLINE hn::Mask<Floats> meets_root(FloatVector x, FloatVector y, FloatVector z,
                                         IntegerVector in_cell) const {
    const Floats d;
    const Integers di;
    const IntegerVector boxes = hn::GatherIndex(di, boxes_, in_cell);
    const auto part = [&](int shift) {
      return hn::ConvertTo(d, hn::And(hn::ShiftRightSame(boxes, shift), hn::Set(di, 31)));
    };
    FloatVector enter = before_, leave = hn::Load(d, end_.data());
    const auto clip = [&](FloatVector plane, std::size_t a) {
      const int shift = static_cast<int>(10 * a);
      // In cells, from plane 0: the cell begins at the plane ahead, or before it.
      const FloatVector cell = hn::Sub(plane, hn::Max(step_[a], hn::Zero(d)));
      const FloatVector unit = hn::Set(d, 1.0f / RootBox::parts);
      const FloatVector low = hn::MulAdd(part(shift), unit, hn::Sub(cell, unit)),
                        high = hn::MulAdd(part(shift + 5), unit, cell);
      const FloatVector at_low = hn::MulAdd(low, delta_[a], first_[a]),
                        at_high = hn::MulAdd(high, delta_[a], first_[a]);
      enter = hn::Max(enter, hn::Min(at_low, at_high));
      leave = hn::Min(leave, hn::Max(at_low, at_high));
    };
    clip(x, 0);
    clip(y, 1);
    clip(z, 2);
    return hn::Le(enter, leave);
  }

  /// The t at which the plane ahead is crossed.
  HWY_INLINE FloatVector next(FloatVector plane, std::size_t a) const {
    return hn::MulAdd(plane, delta_[a], first_[a]);
  }

  HWY_INLINE void advance(FloatVector& x, FloatVector& y, FloatVector& z, IntegerVector& cell,
                          hn::Mask<Floats>& walking) const {
    const Integers di;
    const FloatVector at_x = next(x, 0), at_y = next(y, 1), at_z = next(z, 2);
    const FloatVector nearest = hn::Min(hn::Min(at_x, at_y), at_z);
    walking = hn::And(walking, hn::Lt(nearest, hn::Load(Floats(), end_.data())));
    const auto cross = [&](FloatVector at, FloatVector& plane, std::size_t a) {
      const auto crosses = hn::And(walking, hn::Le(at, nearest));
      plane = hn::Add(plane, hn::IfThenElseZero(crosses, step_[a]));
      cell = hn::Add(cell, hn::IfThenElseZero(hn::RebindMask(di, crosses), stride_[a]));
    };
    cross(at_x, x, 0);
    cross(at_y, y, 1);
    cross(at_z, z, 2);
  }

  const std::int32_t *roots_, *boxes_;
  float cell_reach_;
  FloatVector x_, y_, z_;  // index of the planes ahead
  IntegerVector cell_;
  hn::Mask<Floats> walking_;         // who is in
  FloatVector step_[3];              // from plane to plane
  FloatVector first_[3], delta_[3];  // t at plane 0, and from plane to plane
  IntegerVector stride_[3];          // from cell to cell across the planes ahead
  alignas(64) std::array<std::int32_t, lanes> root_of_;
  alignas(64) std::array<float, lanes> reach_of_;
  alignas(64) std::array<float, lanes> end_;  // t beyond which no cell matters
  FloatVector before_;
  bool begun_ = false;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
