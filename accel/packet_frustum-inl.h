// What bounds the rays of a packet together, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_PACKET_FRUSTUM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_PACKET_FRUSTUM_INL
#undef RAYMETER_PACKET_FRUSTUM_INL
#else
#define RAYMETER_PACKET_FRUSTUM_INL
#endif

#include <algorithm>
#include <cmath>
#include <utility>

#include "accel/ray_packet-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// Two axes of a brick in sixteen lanes: lane i stands for i % 4 along the first of them and i / 4 along the
/// second, counted from where the rays come. This gives the layers that these are.
struct LayerTable {
  alignas(64) std::array<float, 16> layer{};
};
constexpr LayerTable layer_table(bool second, bool down) {
  LayerTable table;
  for (std::size_t i = 0; i < 16; ++i) {
    const auto steps = static_cast<int>(second ? i / 4 : i % 4);
    table.layer[i] = static_cast<float>(down ? 3 - steps : steps);
  }
  return table;
}
/// By whether it is the second axis, and whether the rays go down along it.
inline constexpr LayerTable layer_tables[2][2] = {{layer_table(false, false), layer_table(false, true)},
                                                  {layer_table(true, false), layer_table(true, true)}};

/// Masks of two axes as masks of all cells over them.
HWY_INLINE std::uint64_t over_xy(std::uint64_t pair) {
  return pair * 0x0001000100010001u;
}
HWY_INLINE std::uint64_t over_xz(std::uint64_t pair) {
  pair = (pair | pair << 24u) & 0x000000ff000000ffu;
  pair = (pair | pair << 12u) & 0x000f000f000f000fu;
  return pair * 0x1111u;
}
HWY_INLINE std::uint64_t over_yz(std::uint64_t pair) {
  pair = (pair | pair << 24u) & 0x000000ff000000ffu;
  pair = (pair | pair << 12u) & 0x000f000f000f000fu;
  pair = (pair | pair << 6u) & 0x0303030303030303u;
  pair = (pair | pair << 3u) & 0x1111111111111111u;
  return pair * 0xfu;
}

/// Bounds of rays that go the same way along one axis, k, the longest of the first ray's: on each of the
/// other two, u and v, they lie between two lines over k (Wald et al., "Ray Tracing Animated Scenes using
/// Coherent Grid Traversal", 2006).
///
/// Why nothing is missed. A ray's u is linear in k, so a line that is not below it at both ends of a range of
/// k is not below it within. All is computed in floats, relative to the first ray's origin. S is the distance
/// of the scene's box from there and of the other origins; no slope is beyond 3 and no number beyond 8 S, and
/// what is compared is off by less than 64 times 2^-24 S. All bounds are moved outwards by twice that.
class PacketFrustum {
 public:
  static constexpr std::size_t u_low = 0, u_high = 1, v_low = 2, v_high = 3;

  /// Bounds the candidates that go the same way as the first of them, as far as they meet the grid's box;
  /// returns those that do.
  PacketMask bound(const RayPacket& rays, const FloatGrid& grid, PacketMask candidates) {
    const Floats d;
    const auto leader = static_cast<std::size_t>(std::countr_zero(candidates));
    k_ = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      down_[a] = rays.direction[a][leader] < 0;
      ref_[a] = rays.origin[a][leader];
      if (std::abs(rays.direction[a][leader]) > std::abs(rays.direction[k_][leader])) k_ = a;
    }
    u_ = k_ == 0 ? 1 : 0;
    v_ = k_ == 2 ? 1 : 2;

    // The rays that go the same way, and where they are in the box.
    PacketMask same = 0, alive = 0;
    FloatVector reach = hn::Zero(d), first = hn::Set(d, FLT_MAX), last = hn::Set(d, -FLT_MAX);
    std::array<float, 3> extent;
    for (std::size_t a = 0; a < 3; ++a) extent[a] = grid.layers[a] * grid.size[a];
    rays.clip(grid.low, extent, [&](std::size_t v, FloatVector enter, FloatVector leave) {
      const FloatVector dk = rays.direction[k_].get(v);
      const FloatVector forward = hn::Mul(dk, hn::Set(d, down_[k_] ? -2.0f : 2.0f));
      const FloatVector aside =
          hn::Max(hn::Abs(rays.direction[u_].get(v)), hn::Abs(rays.direction[v_].get(v)));
      const auto along = hn::And(hn::Gt(forward, hn::Zero(d)), hn::Ge(forward, aside));
      const auto meets = hn::And(hn::And(along, hn::Le(enter, leave)), mask_of(vector_bits(candidates, v)));
      same |= packet_bits(bits_of(along), v);
      alive |= packet_bits(bits_of(meets), v);
      for (std::size_t a = 0; a < 3; ++a)
        reach = hn::Max(reach, hn::IfThenElseZero(meets, hn::Abs(offset(rays, a, v))));
      const FloatVector ok = offset(rays, k_, v), in = hn::MulAdd(enter, dk, ok),
                        out = hn::MulAdd(leave, dk, ok);
      first = hn::Min(first, hn::IfThenElse(meets, hn::Min(in, out), first));
      last = hn::Max(last, hn::IfThenElse(meets, hn::Max(in, out), last));
    });
    same_ = same & candidates;
    if (alive == 0) return 0;
    float size = hn::GetLane(hn::MaxOfLanes(d, reach));
    for (std::size_t a = 0; a < 3; ++a)
      size += std::max(std::abs(grid.low[a] - ref_[a]), std::abs(grid.low[a] + extent[a] - ref_[a]));
    slack_ = size * 0x1p-17f + 0x1p-90f;
    from_ = hn::GetLane(hn::MinOfLanes(d, first)) - slack_;
    to_ = hn::GetLane(hn::MaxOfLanes(d, last)) + slack_;

    // The lines, through the bounds at both ends.
    const float length = to_ - from_;  // at least 2 slack_
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t a = side == 0 ? u_ : v_;
      FloatVector low0 = hn::Set(d, FLT_MAX), high0 = hn::Set(d, -FLT_MAX), low1 = low0, high1 = high0;
      for (std::size_t v = 0; v < packet_vectors; ++v) {
        const auto live = mask_of(vector_bits(alive, v));
        const FloatVector slope = hn::Mul(rays.direction[a].get(v), rays.inverse[k_].get(v));
        const FloatVector ok = offset(rays, k_, v), oa = offset(rays, a, v);
        const FloatVector at0 = hn::MulAdd(hn::Sub(hn::Set(d, from_), ok), slope, oa),
                          at1 = hn::MulAdd(hn::Sub(hn::Set(d, to_), ok), slope, oa);
        low0 = hn::Min(low0, hn::IfThenElse(live, at0, low0));
        high0 = hn::Max(high0, hn::IfThenElse(live, at0, high0));
        low1 = hn::Min(low1, hn::IfThenElse(live, at1, low1));
        high1 = hn::Max(high1, hn::IfThenElse(live, at1, high1));
      }
      const auto line = [&](std::size_t i, float at0, float at1) {
        slope_[i] = (at1 - at0) / length;
        base_[i] = at0 - slope_[i] * from_;
      };
      line(2 * side, hn::GetLane(hn::MinOfLanes(d, low0)) - slack_,
           hn::GetLane(hn::MinOfLanes(d, low1)) - slack_);
      line(2 * side + 1, hn::GetLane(hn::MaxOfLanes(d, high0)) + slack_,
           hn::GetLane(hn::MaxOfLanes(d, high1)) + slack_);
    }
    octant_ = (down_[0] ? 1u : 0u) | (down_[1] ? 2u : 0u) | (down_[2] ? 4u : 0u);
    return alive;
  }

  /// The candidates that go the same way.
  PacketMask same() const { return same_; }
  unsigned octant() const { return octant_; }
  std::size_t k() const { return k_; }
  std::size_t u() const { return u_; }
  std::size_t v() const { return v_; }
  bool down(std::size_t axis) const { return down_[axis]; }
  float ref(std::size_t axis) const { return ref_[axis]; }
  float slack() const { return slack_; }
  /// The range of k, relative to ref.
  float from() const { return from_; }
  float to() const { return to_; }
  /// The bounds, in their order, of the rays between two k.
  HWY_INLINE hn::Vec<Floats4> between(float k0, float k1) const {
    const Floats4 d;
    const auto slope = hn::Load(d, slope_.data()), base = hn::Load(d, base_.data());
    const auto at0 = hn::MulAdd(slope, hn::Set(d, k0), base), at1 = hn::MulAdd(slope, hn::Set(d, k1), base);
    return hn::OddEven(hn::Max(at0, at1), hn::Min(at0, at1));
  }

  /// The occupied cells of a brick that any of the rays may pierce, mirrored into their octant.
  HWY_INLINE std::uint64_t pierced(const BrickNode& node) const {
    const std::uint64_t cells = mirrored(node.occupied, octant_);
    const std::uint64_t ku = pair(node, u_low), kv = pair(node, v_low);
    if (k_ == 0) return cells & over_xy(ku) & over_xz(kv);
    if (k_ == 1) return cells & over_xy(ku) & over_yz(kv);
    return cells & over_xz(ku) & over_yz(kv);
  }

  /// The triangles that may lie within the bounds.
  HWY_INLINE hn::Mask<Floats> may_meet(const LaneTriangles& triangles) const {
    const Floats d;
    // A corner's place on an axis, and from there those of the others.
    const auto on = [&](const FloatVec3& v, std::size_t axis) {
      return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
    };
    struct Places {
      FloatVector a, b, c;
    };
    const auto places = [&](std::size_t axis) {
      const FloatVector a = hn::Sub(on(triangles.a, axis), hn::Set(d, ref_[axis]));
      return Places{a, hn::Add(a, on(triangles.e1, axis)), hn::Add(a, on(triangles.e2, axis))};
    };
    const auto least = [&](const Places& p) { return hn::Min(hn::Min(p.a, p.b), p.c); };
    const auto greatest = [&](const Places& p) { return hn::Max(hn::Max(p.a, p.b), p.c); };
    const Places k = places(k_);
    auto within = hn::And(hn::Le(least(k), hn::Set(d, to_)), hn::Ge(greatest(k), hn::Set(d, from_)));
    for (const auto& [axis, low] : {std::pair{u_, u_low}, std::pair{v_, v_low}}) {
      const Places p = places(axis);
      const auto beyond = [&](std::size_t bound) {
        const FloatVector slope = hn::Set(d, slope_[bound]);
        return Places{hn::NegMulAdd(slope, k.a, p.a), hn::NegMulAdd(slope, k.b, p.b),
                      hn::NegMulAdd(slope, k.c, p.c)};
      };
      within = hn::And(within, hn::And(hn::Ge(greatest(beyond(low)), hn::Set(d, base_[low])),
                                       hn::Le(least(beyond(low + 1)), hn::Set(d, base_[low + 1]))));
    }
    return within;
  }
  HWY_INLINE FloatVector offset(const RayPacket& rays, std::size_t axis, std::size_t v) const {
    return hn::Sub(rays.origin[axis].get(v), hn::Set(Floats(), ref_[axis]));
  }

 private:
  /// The cells on k and the axis of the bounds `low` and low + 1 that meet these.
  HWY_INLINE std::uint64_t pair(const BrickNode& node, std::size_t low) const {
    const std::size_t axis = low == u_low ? u_ : v_;
    const Floats d;
    const FloatVector from = hn::Set(d, from_), to = hn::Set(d, to_);
    const FloatVector k_low = hn::Set(d, node.low[k_] - ref_[k_]), k_size = hn::Set(d, node.size[k_]),
                      low_plane = hn::Set(d, node.low[axis] - ref_[axis]), size = hn::Set(d, node.size[axis]);
    const bool low_far = slope_[low] < 0, high_far = slope_[low + 1] > 0;
    const auto& k_layers = layer_tables[k_ > axis][down_[k_]].layer;
    const auto& layers = layer_tables[axis > k_][down_[axis]].layer;
    std::uint64_t bits = 0;
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      const FloatVector k_layer = hn::Load(d, &k_layers[v * lanes]), layer = hn::Load(d, &layers[v * lanes]);
      FloatVector k0 = hn::MulAdd(k_layer, k_size, k_low), k1 = hn::Add(k0, k_size);
      k0 = hn::Min(hn::Max(k0, from), to);
      k1 = hn::Min(hn::Max(k1, from), to);
      const FloatVector least =
          hn::MulAdd(hn::Set(d, slope_[low]), low_far ? k1 : k0, hn::Set(d, base_[low]));
      const FloatVector greatest =
          hn::MulAdd(hn::Set(d, slope_[low + 1]), high_far ? k1 : k0, hn::Set(d, base_[low + 1]));
      const FloatVector near = hn::MulAdd(layer, size, low_plane), far = hn::Add(near, size);
      bits |= bits_of(hn::And(hn::Le(near, greatest), hn::Ge(far, least))) << (v * lanes);
    }
    return bits;
  }

  std::size_t k_, u_, v_;
  std::array<bool, 3> down_;
  std::array<float, 3> ref_;
  float slack_, from_, to_;
  alignas(16) std::array<float, 4> base_, slope_;
  PacketMask same_;
  unsigned octant_;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
