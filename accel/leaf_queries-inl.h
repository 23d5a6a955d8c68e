// What rays ask of the leaves that they meet, for the instruction set of HWY_TARGET: included once for each.
#if defined(RAYMETER_LEAF_QUERIES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMETER_LEAF_QUERIES_INL
#undef RAYMETER_LEAF_QUERIES_INL
#else
#define RAYMETER_LEAF_QUERIES_INL
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "accel/decide_lanes-inl.h"
#include "accel/primitive_test.h"
#include "accel/ray_packet-inl.h"
#include "scenes/geometry/decide.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {

/// A leaf that a ray meets, and how far from its origin some point of each primitive may be (1-norm).
struct Leaf {
  const std::uint32_t* words = nullptr;
  std::uint32_t triangles = 0;  ///< how many
  std::span<const std::uint32_t> others;
  float reach = 0;
  std::uint64_t pierced = 0;  ///< cells

  /// Where the first block from there on begins that may be hit; no less than the number of triangles if
  /// none.
  HWY_INLINE std::uint32_t next_block(std::uint32_t first) const {
    while (first < triangles && (pierced & LeafWords::cells(words, triangles, first)) == 0)
      first += LeafWords::block;
    return first;
  }
  /// The one that begins there.
  TriangleRows block(std::uint32_t first) const { return LeafWords::rows(words, triangles, first); }
};

/// Triangles of a leaf, as many as a vector has lanes.
class LeafBlock {
 public:
  HWY_INLINE LeafBlock(const TriangleRows& rows, std::uint32_t first) : rows_(rows), first_(first) {}

  const TriangleRows& rows() const { return rows_; }
  std::uint32_t column(std::size_t i) const { return first_ + static_cast<std::uint32_t>(i); }
  std::uint32_t primitive(std::size_t i) const { return rows_.primitive(column(i)); }
  Triangle triangle(std::size_t i) const { return rows_.triangle(column(i)); }
  float edge(std::size_t i) const { return rows_.edge(column(i)); }
  float coordinate(std::size_t row, std::size_t i) const { return rows_.row(row)[column(i)]; }
  HWY_INLINE FloatVector edges() const {
    return hn::LoadU(Floats(), rows_.row(TriangleRows::edge_row) + first_);
  }

 private:
  TriangleRows rows_;
  std::uint32_t first_;
};

/// What the rays of a packet ask of the leaves that they meet, together or one by one.
template <class Probe>
class PacketQuery {
 public:
  PacketQuery(const Scene& scene, const Ray* rays, RayPacket& packet, Probe& probe)
      : scene_(scene), rays_(rays), packet_(packet), probe_(probe) {}
  /// These rays are traced from now on.
  void begin(PacketMask rays) { live_ = rays; }
  /// Those of them that are not done yet.
  PacketMask live() const { return live_; }
  void drop(PacketMask done) { live_ &= ~done; }

 protected:
  /// An upper bound of the 1-norm from the ray's origin to the first corner.
  static float reach_of(const Triangle& triangle, const Ray& ray) {
    const Vec3 &a = triangle.a, &from = ray.origin;
    return (std::abs(a.x - from.x) + std::abs(a.y - from.y) + std::abs(a.z - from.z)) * (1 + 0x1p-20f);
  }
  /// The probe, of one of the rays.
  Probe& probe(std::size_t ray) {
    probe_.select(ray);
    return probe_;
  }

  const Scene& scene_;
  const Ray* rays_;
  RayPacket& packet_;
  PacketMask live_ = 0;

 private:
  Probe& probe_;
};

/// The closest hits. Of a ray's hits the one that certainly comes before all others so far is pending: it
/// ends the interval, and its t is found when all is over, for all rays together.
template <class Probe>
class ClosestHits : public PacketQuery<Probe> {
  using Base = PacketQuery<Probe>;
  using Base::live_, Base::packet_, Base::probe, Base::rays_, Base::reach_of, Base::scene_;

 public:
  ClosestHits(const Scene& scene, const Ray* rays, RayPacket& packet, Probe& probe)
      : Base(scene, rays, packet, probe) {
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      for (PacketFloats* const t : {&pending_least_, &best_least_, &best_t_})
        t->set(v, hn::Set(Floats(), no_hit));
      for (PacketIndices* const primitive : {&pending_, &best_})
        primitive->set(v, hn::Set(Indices(), no_primitive));
    }
  }

  /// A triangle of the block, against vector v of the rays.
  HWY_INLINE void consider_triangle(const LeafBlock& block, std::size_t i, std::size_t v,
                                    const BlockTest& test) {
    BlockTest::Bounds t;
    const auto [possible, certain] = test.within(packet_.intervals(v), t);
    if (possible == 0) return;
    const FloatVector least = t.least_t(), greatest = t.greatest_t();
    const std::uint64_t first = bits_of(hn::Lt(greatest, hn::Min(pending_least_.get(v), best_least_.get(v))));
    const std::uint64_t late = bits_of(hn::Gt(least, packet_.after.get(v)));
    if ((certain & first) != 0) {
      const auto better = mask_of(certain & first);
      for (std::size_t row = 0; row < 9; ++row)
        corners_[row].set(v, better, hn::Set(Floats(), block.coordinate(row, i)));
      pending_.set(v, better, hn::Set(Indices(), block.primitive(i)));
      pending_least_.set(v, better, least);
      packet_.after.set(v, better, greatest);
    }
    const PacketMask inside = packet_bits(test.inside(), v);
    for_each_ray(packet_bits(possible & ~(certain & (first | late)), v),
                 [&](std::size_t ray) { decide_on(ray, block, i, inside >> ray & 1u); });
  }
  /// A ray against the block.
  HWY_INLINE void consider_ray(const LeafBlock& block, std::size_t ray, const BlockTest& test) {
    BlockTest::Bounds t;
    const auto [possible, certain] = test.within(packet_.interval_in_all_lanes(ray), t);
    if (possible == 0) return;
    alignas(64) float least[lanes], greatest[lanes];
    hn::Store(t.least_t(), Floats(), least);
    hn::Store(t.greatest_t(), Floats(), greatest);
    for (std::uint64_t rest = possible; rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      if (certain >> i & 1u) {
        if (greatest[i] < std::min(pending_least_[ray], best_least_[ray])) {
          for (std::size_t row = 0; row < 9; ++row) corners_[row][ray] = block.coordinate(row, i);
          pending_[ray] = block.primitive(i);
          pending_least_[ray] = least[i];
          packet_.after[ray] = greatest[i];
          continue;
        }
        if (least[i] > packet_.after[ray]) continue;
      }
      decide_on(ray, block, i, test.inside() >> i & 1u);
    }
  }
  /// Primitives that are not triangles.
  HWY_NOINLINE void consider_others(std::span<const std::uint32_t> primitives, PacketMask active) {
    for_each_ray(active, [&](std::size_t ray) {
      settle(ray);
      const FilterRay filter(rays_[ray]);
      Hit hit = answer(ray);
      for (const std::uint32_t primitive : primitives)
        test_closest(scene_, primitive, filter, hit, probe(ray));
      take(ray, hit);
    });
  }

  /// When all is over, and before `answer`.
  HWY_INLINE void finish() {
    PacketMask open = 0;
    for (std::size_t v = 0; v < packet_vectors; ++v)
      open |= packet_bits(
          bits_of(hn::RebindMask(Floats(), hn::Ne(pending_.get(v), hn::Set(Indices(), no_primitive)))), v);
    if (open == 0) return;
    PacketFloats t{};
    const PacketMask decided = decide_planes(
        packet_, open,
        [&](std::size_t row, std::size_t ray) {
          return hn::PromoteTo(Doubles(), hn::Load(HalfFloats(), &corners_[row].numbers[ray]));
        },
        t);
    for_each_ray(decided, [&](std::size_t ray) { probe(ray).decide(); });
    PacketMask others = 0;
    for (std::size_t v = 0; v < packet_vectors; ++v) {
      const auto hit = hn::And(hn::Lt(t.get(v), hn::Set(Floats(), no_hit)), mask_of(vector_bits(decided, v)));
      const auto only = hn::And(hit, hn::Eq(best_t_.get(v), hn::Set(Floats(), no_hit)));
      others |= packet_bits(bits_of(hit) & ~bits_of(only), v);
      best_t_.set(v, only, t.get(v));
      best_.set(v, only, pending_.get(v));
    }
    for_each_ray(others, [&](std::size_t ray) { take(ray, {t[ray], pending_[ray]}); });
    for_each_ray(open & ~decided, [&](std::size_t ray) { settle(ray); });
  }
  Hit answer(std::size_t ray) const { return {best_t_[ray], best_[ray]}; }

 private:
  using Indices = hn::RebindToUnsigned<Floats>;

  HWY_INLINE void decide_on(std::size_t ray, const LeafBlock& block, std::size_t i, bool inside) {
    const std::uint32_t primitive = block.primitive(i);
    if (primitive == best_[ray] || primitive == pending_[ray]) return;
    const Ray& given = rays_[ray];
    const Triangle triangle = block.triangle(i);
    const PlaneHit plane(given, packet_.scale[ray], triangle, block.edge(i), reach_of(triangle, given));
    if (plane.known()) {
      const auto [low, high] = plane.t();
      if (low > std::min(best_t_[ray], given.tfar) || high <= given.tnear) return;
    }
    take_decided(ray, triangle, primitive, inside);
  }
  /// Apart, for it is rare and long.
  HWY_NOINLINE void take_decided(std::size_t ray, const Triangle& triangle, std::uint32_t primitive,
                                 bool inside) {
    settle(ray);
    probe(ray).decide();
    take(ray, {inside ? decide_inside(rays_[ray], triangle) : decide(rays_[ray], triangle), primitive});
  }
  void settle(std::size_t ray) {
    const std::uint32_t primitive = std::exchange(pending_[ray], no_primitive);
    if (primitive == no_primitive) return;
    pending_least_[ray] = no_hit;
    const auto corner = [&](std::size_t row) {
      return Vec3{corners_[row][ray], corners_[row + 1][ray], corners_[row + 2][ray]};
    };
    probe(ray).decide();
    take(ray, {decide_inside(rays_[ray], {corner(0), corner(3), corner(6)}), primitive});
  }
  void take(std::size_t ray, const Hit& hit) {
    if (hit.t == no_hit || !(hit < answer(ray))) return;
    best_t_[ray] = hit.t;
    best_[ray] = hit.primitive;
    best_least_[ray] = scaled_down(hit.t, packet_.scale[ray]);
    packet_.after[ray] = std::min(packet_.after[ray], scaled_up(hit.t, packet_.scale[ray]));
  }

  PacketFloats pending_least_, best_least_;  // of their t, at least, scaled
  std::array<PacketFloats, 9> corners_{};    // of the pending triangles
  PacketIndices pending_;
  PacketFloats best_t_;
  PacketIndices best_;
};

/// Whether there are any hits.
template <class Probe>
class AnyHits : public PacketQuery<Probe> {
  using Base = PacketQuery<Probe>;
  using Base::live_, Base::packet_, Base::probe, Base::rays_, Base::reach_of, Base::scene_;

 public:
  using Base::Base;

  HWY_INLINE void consider_triangle(const LeafBlock& block, std::size_t i, std::size_t v,
                                    const BlockTest& test) {
    BlockTest::Bounds t;
    const auto [possible, certain] = test.within(packet_.intervals(v), t);
    hit(packet_bits(certain, v));
    const PacketMask open = packet_bits(possible & ~certain, v);
    if (open != 0) decide_on(open, block, i, packet_bits(test.inside(), v));
  }
  HWY_INLINE void consider_ray(const LeafBlock& block, std::size_t ray, const BlockTest& test) {
    const PacketMask one = PacketMask{1} << ray;
    BlockTest::Bounds t;
    const auto [possible, certain] = test.within(packet_.interval_in_all_lanes(ray), t);
    if (certain != 0) return hit(one);
    for (std::uint64_t rest = possible; rest != 0 && (live_ & one) != 0; rest &= rest - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rest));
      probe(ray).decide();
      decide_one(ray, block, i, test.inside() >> i & 1u);
    }
  }
  HWY_NOINLINE void consider_others(std::span<const std::uint32_t> primitives, PacketMask active) {
    for_each_ray(active, [&](std::size_t ray) {
      const FilterRay filter(rays_[ray]);
      if (std::ranges::any_of(primitives, [&](auto p) { return test_any(scene_, p, filter, probe(ray)); }))
        hit(PacketMask{1} << ray);
    });
  }

  void finish() {}
  bool answer(std::size_t ray) const { return hits_ >> ray & 1u; }

 private:
  /// `inside`: the rays that certainly pass inside.
  HWY_NOINLINE void decide_on(PacketMask open, const LeafBlock& block, std::size_t i, PacketMask inside) {
    for_each_ray(open, [&](std::size_t ray) { probe(ray).decide(); });
    if (std::popcount(open) > few) {
      PacketFloats t{};
      const PacketMask decided = decide_planes(
          packet_, open,
          [&](std::size_t row, std::size_t) { return hn::Set(Doubles(), double(block.coordinate(row, i))); },
          t);
      PacketMask met = 0;
      for (std::size_t v = 0; v < packet_vectors; ++v)
        met |= packet_bits(bits_of(hn::Lt(t.get(v), hn::Set(Floats(), no_hit))), v);
      hit(decided & met & inside);
      open &= ~decided | (met & ~inside);
    }
    for_each_ray(open, [&](std::size_t ray) { decide_one(ray, block, i, inside >> ray & 1u); });
  }
  HWY_INLINE void decide_one(std::size_t ray, const LeafBlock& block, std::size_t i, bool inside) {
    const Ray& given = rays_[ray];
    if (decide_any(given, packet_.scale[ray], block.rows(), block.column(i), inside,
                   reach_of(block.triangle(i), given)))
      hit(PacketMask{1} << ray);
  }
  void hit(PacketMask rays) {
    hits_ |= rays;
    live_ &= ~rays;
  }

  /// So many rays are decided sooner one by one.
  static constexpr int few = 3;
  PacketMask hits_ = 0;
};

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
#endif
