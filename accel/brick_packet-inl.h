// Sixteen rays that go the same way, together through the bricks, for the instruction set of HWY_TARGET:
// included once for each.
#if defined(RAYMETER_BRICK_PACKET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_BRICK_PACKET_INL
#undef RAYMETER_BRICK_PACKET_INL
#else
#define RAYMETER_BRICK_PACKET_INL
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>
#include <utility>

#include "accel/leaf_queries-inl.h"
#include "accel/packet_frustum-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// The edges of such triangles, for one after the other.
class BlockEdges {
 public:
  explicit HWY_INLINE BlockEdges(const LaneTriangles& triangles) {
    const Floats d;
    const auto put = [&](std::size_t row, const FloatVec3& v) {
      hn::Store(v.x, d, rows_[row]);
      hn::Store(v.y, d, rows_[row + 1]);
      hn::Store(v.z, d, rows_[row + 2]);
    };
    put(0, triangles.e1);
    put(3, triangles.e2);
  }
  /// One in all lanes.
  HWY_INLINE LaneTriangles one(const LeafBlock& block, std::size_t i) const {
    const Floats d;
    const auto corner = [&](std::size_t row) { return hn::Set(d, block.coordinate(row, i)); };
    const auto edge = [&](std::size_t row) { return hn::Set(d, rows_[row][i]); };
    return {{corner(0), corner(1), corner(2)}, {edge(0), edge(1), edge(2)}, {edge(3), edge(4), edge(5)}};
  }

 private:
  alignas(64) float rows_[6][lanes];
};

/// The triangles that a packet has met of late: long ones lie in many leaves.
class PacketMailbox {
 public:
  PacketMailbox() { last_.fill(no_primitive); }
  /// Whether it is not one of them; then it becomes one.
  HWY_INLINE bool is_new(std::uint32_t primitive) {
    return std::exchange(last_[primitive % last_.size()], primitive) != primitive;
  }

 private:
  alignas(64) std::array<std::uint32_t, 32> last_;
};

/// How much the packets of late had in common: the rays that met each leaf. Where these are few, next ones
/// are rather traced ray by ray, and only now and then a packet, to see whether it is better.
class PacketSharing {
 public:
  /// Whether to trace a packet now.
  bool worth_while() {
    if (pause_ == 0) return true;
    --pause_;
    return false;
  }
  void learn(std::uint32_t leaves, std::uint32_t rays) {
    leaves_ = leaves_ - leaves_ / 4 + leaves;
    rays_ = rays_ - rays_ / 4 + rays;
    if (rays_ < fewest_rays * leaves_) pause_ = longest_pause;
  }

 private:
  static constexpr std::uint32_t fewest_rays = 3, longest_pause = 7;
  std::uint32_t leaves_ = 0, rays_ = 0, pause_ = 0;
};

/// Takes a packet through the grid and the bricks.
template <class Query, class Probe>
class PacketWalk {
 public:
  PacketWalk(const Bricks& bricks, const RayPacket& rays, const PacketFrustum& frustum, Query& query,
             Probe& probe)
      : bricks_(bricks), rays_(rays), frustum_(frustum), query_(query), probe_(probe) {}

  /// Visits the cells of the grid that the rays may pierce, slice by slice across k.
  HWY_INLINE void walk_grid() {
    const FloatGrid& grid = bricks_.grid;
    const std::size_t k = frustum_.k(), u = frustum_.u(), v = frustum_.v();
    const bool down = frustum_.down(k);
    // Slices, and in them the cells between the bounds.
    const float grid_low = grid.low[k] - frustum_.ref(k);
    const auto slice_of = [&](float place) {
      return std::clamp((place - grid_low) * grid.inverse_size[k], 0.0f, grid.layers[k] - 1);
    };
    auto slice = static_cast<std::int32_t>(slice_of(down ? frustum_.to() : frustum_.from()));
    const auto last = static_cast<std::int32_t>(slice_of(down ? frustum_.from() : frustum_.to()));
    const Floats4 d;
    const auto by_bound = [&](const auto& number) {
      alignas(16) const std::array<float, 4> numbers{number(u), number(u), number(v), number(v)};
      return hn::Load(d, numbers.data());
    };
    const auto low = by_bound([&](std::size_t axis) { return grid.low[axis] - frustum_.ref(axis); }),
               inverse_size = by_bound([&](std::size_t axis) { return grid.inverse_size[axis]; }),
               most = by_bound([&](std::size_t axis) { return grid.layers[axis] - 1; });
    bool visited = false;
    while (true) {
      const float slice_low = grid_low + static_cast<float>(slice) * grid.size[k],
                  slice_high = grid_low + static_cast<float>(slice + 1) * grid.size[k];
      if (std::exchange(visited, false)) drop_done(down ? slice_high : slice_low);
      if (query_.live() == 0) return;
      const auto bounds = frustum_.between(std::clamp(slice_low, frustum_.from(), frustum_.to()),
                                           std::clamp(slice_high, frustum_.from(), frustum_.to()));
      const auto place = hn::Mul(hn::Sub(bounds, low), inverse_size);
      const hn::RebindToSigned<Floats4> di;
      alignas(16) std::array<std::int32_t, 4> cells;
      hn::Store(hn::ConvertTo(di, hn::Min(hn::Max(place, hn::Zero(d)), most)), di, cells.data());
      const auto [u0, u1, v0, v1] = cells;
      for (std::int32_t j = 0; j <= v1 - v0; ++j)
        for (std::int32_t i = 0; i <= u1 - u0; ++i) {
          const std::int32_t cell = slice * grid.stride[k] +
                                    (frustum_.down(u) ? u1 - i : u0 + i) * grid.stride[u] +
                                    (frustum_.down(v) ? v1 - j : v0 + j) * grid.stride[v];
          const std::uint32_t root = bricks_.roots[static_cast<std::size_t>(cell)];
          if (root == Bricks::empty_cell) {
            count(query_.live(), [&] { probe_.cell_step(true); });
          } else {
            walk_bricks(root);
            visited = true;
            if (query_.live() == 0) return;
          }
        }
      if (slice == last) return;
      slice += down ? -1 : 1;
    }
  }

  /// Leaves visited, and the rays that met each of them.
  std::uint32_t leaves() const { return leaves_; }
  std::uint32_t rays_in_leaves() const { return rays_in_leaves_; }

 private:
  /// Tells the probe something of each of some rays.
  template <class F>
  HWY_INLINE void count(PacketMask rays, const F& f) {
    if constexpr (!std::is_same_v<Probe, NoProbe>)
      for_each_ray(rays, [&](std::size_t ray) {
        probe_.select(ray);
        f();
      });
  }

  /// The rays for which nothing matters beyond a plane across k are done.
  HWY_INLINE void drop_done(float plane) {
    const Floats d;
    const std::size_t k = frustum_.k();
    const float before = frustum_.down(k) ? plane + frustum_.slack() : plane - frustum_.slack();
    PacketMask done = 0;
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      const FloatVector enter =
          hn::Mul(hn::Sub(hn::Set(d, before), frustum_.offset(rays_, k, v)), rays_.inverse[k].get(v));
      done |= packet_bits(bits_of(hn::Gt(hn::Mul(enter, hn::Set(d, 1 - 0x1p-20f)), rays_.after.get(v))), v);
    }
    query_.drop(done);
  }

  /// As TreeWalk.
  HWY_NOINLINE void walk_bricks(std::uint32_t root) {
    struct Level {
      std::uint64_t rest;
      const BrickNode* node;
    };
    Level stack[deepest_brick + 1];
    std::uint32_t depth = 0;
    const BrickNode* node = &bricks_.nodes[root];
    while (true) {
      const PacketMask active = rays_.meet(*node) & query_.live();
      const std::uint64_t cells = active != 0 ? frustum_.pierced(*node) : 0;
      if (cells != 0 && node->is_leaf()) {
        ++leaves_;
        rays_in_leaves_ += static_cast<std::uint32_t>(std::popcount(active));
        count(active, [&] { probe_.cell_step(false); });
        visit(*node, active, mirrored(cells, frustum_.octant()));
        if (query_.live() == 0) return;
      } else {
        count(active, [&] { probe_.inner_step(); });
        if (cells != 0) stack[depth++] = {cells, node};
      }
      while (depth != 0 && stack[depth - 1].rest == 0) --depth;
      if (depth == 0) return;
      Level& level = stack[depth - 1];
      const auto cell = static_cast<unsigned>(std::countr_zero(level.rest)) ^ mirror_of[frustum_.octant()];
      level.rest &= level.rest - 1;
      node = &bricks_.nodes[level.node->child(cell)];
    }
  }

  HWY_INLINE void visit(const BrickNode& leaf, PacketMask active, std::uint64_t pierced) {
    const std::uint32_t* const words = bricks_.words.data() + leaf.base;
    for (std::uint32_t i = 0; i < leaf.triangles; i += lanes) {
      const std::uint32_t first = i % LeafWords::block, begin = i - first;
      if ((pierced & LeafWords::cells(words, leaf.triangles, begin)) == 0) continue;
      active &= query_.live();
      const auto rays = static_cast<std::size_t>(std::popcount(active));
      const TriangleRows rows = LeafWords::rows(words, leaf.triangles, begin);
      const LeafBlock block(rows, first);
      const LaneTriangles triangles = triangles_of(rows, first);
      std::uint64_t kept = lanes_from(rows, first);
      if (rays > few) kept &= bits_of(frustum_.may_meet(triangles));
      // Whichever takes fewer tests.
      if (rays < packet_vectors * static_cast<std::size_t>(std::popcount(kept)))
        test_rays(block, triangles, kept, active);
      else if (kept != 0)
        test_triangles(block, BlockEdges(triangles), kept);
      if (query_.live() == 0) return;
    }
    if (leaf.others != 0)
      query_.consider_others({words + LeafWords::count(leaf.triangles), leaf.others}, active & query_.live());
  }
  /// Each ray against the block.
  HWY_INLINE void test_rays(const LeafBlock& block, const LaneTriangles& triangles, std::uint64_t kept,
                            PacketMask active) {
    count(active, [&] {
      probe_.test_block();
      for (std::uint64_t rest = kept; rest != 0; rest &= rest - 1)
        probe_.test(block.primitive(static_cast<std::size_t>(std::countr_zero(rest))));
    });
    for_each_ray(active, [&](std::size_t ray) {
      const BlockTest test = test_pairs(
          in_all_lanes(rays_.origin, ray), in_all_lanes(rays_.direction, ray), triangles,
          [&] { return block.edges(); }, kept);
      if (test.candidates != 0) query_.consider_ray(block, ray, test);
    });
  }
  /// Each triangle against all rays, also those that pass beside the leaf: it need not be tested again.
  HWY_INLINE void test_triangles(const LeafBlock& block, const BlockEdges& edges, std::uint64_t kept) {
    for (; kept != 0; kept &= kept - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(kept));
      if (!mailbox_.is_new(block.primitive(i))) continue;
      const LaneTriangles triangle = edges.one(block, i);
      count(query_.live(), [&] {
        probe_.test_block();
        probe_.test(block.primitive(i));
      });
      for (std::size_t v = 0; v < packet_vectors; ++v) {
        const BlockTest test = test_pairs(
            vector_of(rays_.origin, v), vector_of(rays_.direction, v), triangle,
            [&] { return hn::Set(Floats(), block.coordinate(TriangleRows::edge_row, i)); },
            vector_bits(query_.live(), v));
        if (test.candidates != 0) query_.consider_triangle(block, i, v, test);
      }
    }
  }
  /// The reach is the distance of the first corner.
  template <class Edge>
  static HWY_INLINE BlockTest test_pairs(const FloatVec3& origin, const FloatVec3& direction,
                                         const LaneTriangles& triangles, const Edge& edge_of,
                                         std::uint64_t there) {
    return test_lanes(origin, direction, triangles, edge_of, norm_of(minus(origin, triangles.a)), there);
  }

  /// Triangles are not sorted out for so few rays.
  static constexpr std::size_t few = 2;

  const Bricks& bricks_;
  const RayPacket& rays_;
  const PacketFrustum& frustum_;
  Query& query_;
  Probe& probe_;
  PacketMailbox mailbox_;
  std::uint32_t leaves_ = 0, rays_in_leaves_ = 0;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
