// The walk of rays through the grid of roots, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_BRICK_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_WALK_INL
#undef RAYMETER_BRICK_WALK_INL
#else
#define RAYMETER_BRICK_WALK_INL
#endif

#include <bit>
#include <span>
#include <type_traits>

#include "accel/brick_ray-inl.h"
#include "accel/leaf_grid.h"
#include "accel/probe.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// As many independent rays as a vector has lanes, made ready and taken from root to root, all at once: the
/// steps of this are few and alike. What is below a root is then done ray by ray.
///
/// A 3DDDA as in grid_walk.h, in floats. Why no cell is missed: an axis' planes are crossed at first + index
/// * delta, which grows with the index however it is rounded, and at any t the walk is in the layer between
/// the two planes whose t enclose it. So its place is wrong by no more than what the rounding of a t means in
/// space: less than 2^-18 of the diagonal, for rays that start within four diagonals. Primitives are
/// registered in every cell that they come as near to as the margin of Bricks::space, which is more.
class BrickWalk {
 public:
  /// At most as many rays as there are lanes. They must outlive this.
  HWY_INLINE BrickWalk(const Bricks& bricks, std::span<const Ray> rays)
      : BrickWalk(bricks.grid, bricks.roots.data(), bricks.root_boxes.data(), rays) {}
  HWY_INLINE BrickWalk(const LeafGrid& grid, std::span<const Ray> rays)
      : BrickWalk(grid.grid, grid.leaves.data(), nullptr, rays) {}

  /// The set of rays that this is proved for, by bits: not those that start far away, or look behind their
  /// origin, or whose direction would leave the range of floats. The others are not walked.
  std::uint64_t taken() const { return taken_; }
  const BrickRay& ray(std::size_t lane) const { return rays_[lane]; }

  float tnear(std::size_t lane) const { return tnear_[lane]; }

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
      const auto at_root = hn::AndNot(hn::RebindMask(d, hn::Eq(root, hn::Set(di, no_root))), walking);
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
  /// `roots`: by cell, whatever they number; no_root where there is none. `boxes`: of the roots, by cell, or
  /// null.
  HWY_INLINE BrickWalk(const FloatGrid& grid, const std::uint32_t* roots, const RootBox* boxes,
                       std::span<const Ray> rays)
      : roots_(reinterpret_cast<const std::int32_t*>(roots)),
        boxes_(reinterpret_cast<const std::int32_t*>(boxes)),
        cell_reach_(grid.cell_reach) {
    const Floats d;
    const Integers di;
    // One row for each number of a ray.
    alignas(64) std::array<std::array<float, lanes>, 8> rows;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const Ray& ray = rays[std::min(lane, rays.size() - 1)];
      const std::array<float, 8> numbers{ray.origin.x,    ray.origin.y,    ray.origin.z,    ray.tnear,
                                         ray.direction.x, ray.direction.y, ray.direction.z, ray.tfar};
      for (std::size_t i = 0; i < 8; ++i) rows[i][lane] = numbers[i];
    }
    const auto row = [&](std::size_t i) { return hn::Load(d, rows[i].data()); };
    const FloatVector tnear = row(3), tfar = row(7), zero = hn::Zero(d), one = hn::Set(d, 1.0f);

    // The greatest power of two that is not above the norm of the direction, and its inverse.
    const FloatVector norm = hn::Add(hn::Abs(row(4)), hn::Add(hn::Abs(row(5)), hn::Abs(row(6))));
    const IntegerVector exponent = hn::And(hn::BitCast(di, norm), hn::Set(di, 0x7f800000));
    const FloatVector scale = hn::BitCast(d, exponent),
                      inverse_scale = hn::BitCast(d, hn::Sub(hn::Set(di, 0x7f000000), exponent));
    // Whether floats do. Each is false of NaN.
    auto taken =
        hn::And(hn::FirstN(d, rays.size()),
                hn::And(hn::And(hn::Gt(norm, hn::Set(d, 0x1p-100f)), hn::Lt(norm, hn::Set(d, 0x1p100f))),
                        hn::And(hn::Ge(tnear, zero), hn::Eq(tfar, tfar))));

    const FloatVector least = hn::Set(d, FLT_MIN), most = hn::Set(d, FLT_MAX);
    FloatVector enter = hn::Mul(hn::Mul(hn::Min(tnear, most), scale), hn::Set(d, 1 - 0x1p-20f));
    hn::Store(enter, d, tnear_.data());
    FloatVector leave = hn::MulAdd(hn::Mul(hn::Max(tfar, least), scale), hn::Set(d, 1 + 0x1p-20f), least);
    FloatVector from_origin[3], inverse[3], along[3];
    IntegerVector octant = hn::Zero(di);
    for (std::size_t a = 0; a < 3; ++a) {
      const FloatVector origin = row(a);
      taken = hn::And(taken, hn::And(hn::Ge(origin, hn::Set(d, grid.nearby_low[a])),
                                     hn::Le(origin, hn::Set(d, grid.nearby_high[a]))));
      along[a] = hn::Mul(row(4 + a), inverse_scale);
      inverse[a] = hn::Div(one, hn::CopySign(hn::Max(hn::Abs(along[a]), hn::Set(d, 0x1p-40f)), along[a]));
      const auto is_down = hn::Lt(inverse[a], zero);
      octant = hn::Or(octant, hn::IfThenElseZero(hn::RebindMask(di, is_down), hn::Set(di, 1 << a)));
      // The part inside the box.
      from_origin[a] = hn::Sub(hn::Set(d, grid.low[a]), origin);
      first_[a] = hn::Mul(from_origin[a], inverse[a]);
      delta_[a] = hn::Mul(hn::Set(d, grid.size[a]), inverse[a]);
      const FloatVector last = hn::MulAdd(hn::Set(d, grid.layers[a]), delta_[a], first_[a]);
      enter = hn::Max(enter, hn::Min(first_[a], last));
      leave = hn::Min(leave, hn::Max(first_[a], last));
    }
    FloatVector plane[3];
    cell_ = hn::Zero(di);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto is_up = hn::Gt(inverse[a], zero);
      const FloatVector place =
          hn::Mul(hn::MulSub(along[a], enter, from_origin[a]), hn::Set(d, grid.inverse_size[a]));
      const FloatVector layer = hn::Floor(hn::Min(hn::Max(place, zero), hn::Set(d, grid.layers[a] - 1)));
      const IntegerVector stride = hn::Set(di, grid.stride[a]);
      cell_ = hn::Add(cell_, hn::Mul(hn::ConvertTo(di, layer), stride));
      // The planes ahead. The last of them is crossed at `leave`, or after.
      plane[a] = hn::IfThenElse(is_up, hn::Add(layer, one), layer);
      step_[a] = hn::IfThenElse(is_up, one, hn::Neg(one));
      stride_[a] = hn::IfThenElse(hn::RebindMask(di, is_up), stride, hn::Neg(stride));
    }

    taken_ = bits_of(taken);
    hn::Store(leave, d, end_.data());
    walking_ = hn::And(taken, hn::Le(enter, leave));
    x_ = plane[0];
    y_ = plane[1];
    z_ = plane[2];

    alignas(64) std::array<std::array<float, lanes>, 7> out;
    alignas(64) std::array<std::int32_t, lanes> octants;
    for (std::size_t a = 0; a < 3; ++a) {
      hn::Store(along[a], d, out[a].data());
      hn::Store(inverse[a], d, out[3 + a].data());
    }
    hn::Store(scale, d, out[6].data());
    hn::Store(octant, di, octants.data());
    for (std::size_t lane = 0; lane < rays.size(); ++lane)
      rays_[lane] = {&rays[lane],
                     {out[0][lane], out[1][lane], out[2][lane]},
                     {out[3][lane], out[4][lane], out[5][lane]},
                     out[6][lane],
                     static_cast<unsigned>(octants[lane])};
  }

  static constexpr std::int32_t no_root = -1;
  static_assert(static_cast<std::uint32_t>(no_root) == Bricks::empty_cell &&
                static_cast<std::uint32_t>(no_root) == LeafGrid::empty_cell);

  /// Whether the box of the present cell's root lies on the way.
  HWY_INLINE hn::Mask<Floats> meets_root(FloatVector x, FloatVector y, FloatVector z,
                                         IntegerVector in_cell) const {
    const Floats d;
    const Integers di;
    const IntegerVector boxes = hn::GatherIndex(di, boxes_, in_cell);
    const auto part = [&](int shift) {
      return hn::ConvertTo(d, hn::And(hn::ShiftRightSame(boxes, shift), hn::Set(di, 31)));
    };
    FloatVector enter = hn::Load(d, tnear_.data()), leave = hn::Load(d, end_.data());
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
  alignas(64) std::array<float, lanes> tnear_, reach_of_;
  alignas(64) std::array<float, lanes> end_;  // t beyond which no cell matters
  std::array<BrickRay, lanes> rays_;
  std::uint64_t taken_;
  bool begun_ = false;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
