// What the test of a block of triangles claims, against the exact answers: for every triangle of a leaf, not
// only for the ones that decide a walk.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/accel/triangle_block_test.cpp"  // this file, for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include <gtest/gtest.h>

#include <span>
#include <utility>
#include <vector>

#include "accel/triangle_block-inl.h"
#include "scenes/base/float_mode.h"
#include "scenes/geometry/decide.h"
#include "tests/scenes/geometry/adversary.h"
#include "tests/scenes/geometry/exact_reference.h"

#ifndef RAYMETER_TRIANGLE_BLOCK_TEST  // once, before all targets
#define RAYMETER_TRIANGLE_BLOCK_TEST
namespace raymeter {

/// A lane of BlockTest, and of PlaneHit what holds where it is known.
struct TriangleClaim {
  bool candidate, inside, certain, known;
  double height, det, height_error, det_error;
  float low, high;  // of t
};
struct BlockTester {
  const char* isa;
  /// What is claimed of all triangles of a leaf, when hits up to tmax matter.
  void (*test)(const FilterRay&, const std::uint32_t* words, float tmax, std::span<TriangleClaim>);
};

}  // namespace raymeter
#endif

#if HWY_TARGET == HWY_SSE4 || HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace raymeter::HWY_NAMESPACE {
namespace {

void test_leaf(const FilterRay& filter, const std::uint32_t* words, float tmax,
               std::span<TriangleClaim> claims) {
  const FlushDenormals mode;
  const Floats d;
  const auto in_lanes = [&](const Vec3& v) {
    return FloatVec3{hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
  };
  const FloatVec3 origin = in_lanes(filter.ray.origin), direction = in_lanes(filter.direction);
  const auto scale = static_cast<float>(filter.scale);
  const float tnear = filter.ray.tnear, tfar = filter.ray.tfar;
  const LaneIntervals interval{hn::Set(d, scaled_down(tnear, scale)),
                               hn::Set(d, std::min(scaled_up(tfar, scale), scaled_up(tmax, scale))),
                               hn::Set(d, scaled_up(tnear, scale)), hn::Set(d, scaled_down(tfar, scale))};
  const TriangleRows rows{words, static_cast<std::uint32_t>(claims.size())};
  float reach = 0;
  for (std::uint32_t i = 0; i < rows.count; ++i) {
    // The least that it may be: of the nearest points of the boxes, the farthest.
    const Bounds box = bounds_of(rows.triangle(i));
    double nearest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = filter.ray.origin[axis];
      nearest += std::max({0.0, box.low[axis] - at, at - box.high[axis]});
    }
    reach = std::max(reach, -float_below(-nearest));
  }
  for (std::uint32_t first = 0; first < rows.count; first += lanes) {
    const BlockTest test = test_block(origin, direction, rows, first, reach);
    BlockTest::Bounds t;
    const auto [possible, certain] = test.within(interval, t);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      const auto claimed = [&](std::uint64_t lanes_of) { return (lanes_of >> lane & 1u) != 0; };
      const std::uint32_t i = first + lane;
      if (i < rows.count) {
        const PlaneHit plane(filter.ray, scale, rows.triangle(i), rows.edge(i), reach);
        const auto [low, high] = plane.t();
        claims[i] = {claimed(possible), claimed(test.inside()), claimed(certain), plane.known(), plane.height,
                     plane.det,         plane.height_error,     plane.det_error,  low,           high};
      } else {
        EXPECT_FALSE(claimed(possible) || claimed(certain)) << "there is no such triangle";
      }
    }
  }
}

}  // namespace

const BlockTester& block_tester() {
  constexpr const char* isa = HWY_TARGET == HWY_AVX3 ? "avx512" : HWY_TARGET == HWY_AVX2 ? "avx2" : "sse42";
  static constexpr BlockTester tester{isa, test_leaf};
  return tester;
}

}  // namespace raymeter::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace raymeter {
namespace {

std::vector<const BlockTester*> testers() {
  std::vector<const BlockTester*> all;
#if HWY_ARCH_X86
  const auto supported = hwy::SupportedTargets();
  if (supported & HWY_AVX3) all.push_back(&N_AVX3::block_tester());
  if (supported & HWY_AVX2) all.push_back(&N_AVX2::block_tester());
  if (supported & HWY_SSE4) all.push_back(&N_SSE4::block_tester());
#endif
  return all;
}

/// A leaf of triangles, and the exact answers to a ray.
struct Leaf {
  explicit Leaf(std::vector<Triangle> given) : triangles(std::move(given)) {
    const auto count = static_cast<std::uint32_t>(triangles.size());
    words.resize(TriangleRows::rows * count + widest_vector);
    for (std::uint32_t i = 0; i < count; ++i) TriangleRows::put(words.data(), count, i, triangles[i], i);
  }
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> words;
};

/// Often much smaller than its neighbours, at one of its corners.
Triangle some_triangle(Random& random, adversary::Style style) {
  Triangle triangle = adversary::triangle(random, style);
  if (random.below(2) == 0) {
    const float scale = std::ldexp(random.uniform(0.5f, 1), -int(random.below(20)));
    triangle.b = triangle.a + scale * (triangle.b - triangle.a);
    triangle.c = triangle.a + scale * (triangle.c - triangle.a);
  }
  return triangle;
}

/// At a triangle from near or far, from it, almost along it, or from close to a corner.
Ray some_ray(Random& random, adversary::Style style, const Triangle& target) {
  const Vec3 point = adversary::point_on(random, target);
  Ray ray = adversary::ray_towards(random, style, point);
  switch (random.below(6)) {
    case 0:
      ray.origin = point;
      break;
    case 1: {
      const float away = std::ldexp(random.uniform(0.5f, 1), int(random.below(40)) - 20);
      ray.origin = point - away * ray.direction;
      break;
    }
    case 2: {
      const float off = std::ldexp(random.uniform(-1, 1), -int(random.below(26)));
      ray.direction = random.uniform(-1, 1) * (target.b - target.a) +
                      random.uniform(-1, 1) * (target.c - target.a) + off * ray.direction;
      ray.origin = point - random.uniform(0, 2) * ray.direction;
      break;
    }
    case 3: {
      const float off = std::ldexp(1.0f, -int(random.below(30)));
      ray.origin = target.a + off * ray.direction;
      ray.direction = point - ray.origin;
      break;
    }
    default:
      break;
  }
  return ray;
}

/// Triangles whose edges pass as near by a ray as floats can be, at about the same t.
struct CloseCall {
  Ray ray;
  std::vector<Triangle> triangles;
};
CloseCall close_call(Random& random) {
  const auto vector = [&] {
    Vec3 v = adversary::point(random, adversary::Style::natural);
    if (random.below(3) == 0) v[int(random.below(3))] = 0;
    return v;
  };
  CloseCall made;
  Ray& ray = made.ray;
  ray.origin = vector();
  ray.direction = vector();
  if (random.below(3) == 0) {
    ray.direction = {};
    ray.direction[int(random.below(3))] = random.below(2) == 0 ? 1.0f : -1.0f;
  }
  // Large triangles near the ray's origin, and small ones far away.
  const float scale = random.below(4) == 0 ? std::ldexp(1.0f, int(random.below(130)) - 65) : 1;
  const float near = std::ldexp(1.0f, -int(random.below(20))),
              size = std::ldexp(1.0f, -int(random.below(20)));
  const float t = near * random.uniform(0.5f, 1);
  for (int i = 0; i < 32; ++i) {
    const Vec3 point = ray.origin + t * ray.direction, edge = size * vector();
    Vec3 corners[3] = {point + edge, point - random.uniform(0, 2) * edge, point + size * vector()};
    if (random.below(4) == 0) corners[1] = point;
    if (random.below(4) == 0) corners[1] = corners[0] + random.uniform(-1, 1) * (corners[2] - corners[0]);
    const unsigned turn = random.below(3);
    made.triangles.push_back(
        {scale * corners[turn], scale * corners[(turn + 1) % 3], scale * corners[(turn + 2) % 3]});
  }
  ray.origin = scale * ray.origin;
  ray.direction = std::ldexp(1.0f, int(random.below(3)) - 1) * scale * ray.direction;
  return made;
}

/// Whether a double lies within `error` of an integer in units of 2^-447, as products of three lengths are.
bool is_near(double x, double error, const reference::Integer& exact) {
  if (std::isinf(error)) return true;
  using boost::multiprecision::cpp_rational;
  const cpp_rational unit = cpp_rational(1, boost::multiprecision::cpp_int(1) << 447);
  return abs(cpp_rational(x) - cpp_rational(boost::multiprecision::cpp_int(exact)) * unit) <=
         cpp_rational(error);
}

class TriangleBlock : public testing::TestWithParam<const BlockTester*> {
 protected:
  std::vector<TriangleClaim> claims(const Leaf& leaf, const FilterRay& ray, float tmax) const {
    std::vector<TriangleClaim> result(leaf.triangles.size());
    GetParam()->test(ray, leaf.words.data(), tmax, result);
    return result;
  }

  /// Whether everything that is claimed about a leaf holds.
  void expect_true_claims(const Leaf& leaf, const Ray& ray, float tmax, bool exactly = false) {
    const FilterRay filter(ray);
    // Others are not tested in blocks.
    if (!is_traceable(ray) || ray.tnear < 0 || filter.scale < 0x1p-100 || filter.scale > 0x1p100) return;
    const Ray line{ray.origin, -no_hit, ray.direction, no_hit};
    std::vector<float> truth;
    for (const Triangle& triangle : leaf.triangles)
      truth.push_back(exactly ? reference::decide(ray, triangle) : decide(ray, triangle));

    const auto all = claims(leaf, filter, tmax);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const TriangleClaim& claim = all[i];
      const Triangle& triangle = leaf.triangles[i];
      const float t = truth[i];
      ASSERT_TRUE(claim.candidate || t == no_hit || t > tmax) << "the hit at " << t << " is rejected";
      if (claim.inside) {
        ASSERT_EQ(decide_inside(line, triangle), decide(line, triangle)) << "is not inside";
      }
      if (claim.certain) {
        ASSERT_TRUE(claim.candidate && claim.inside);
        ASSERT_NE(t, no_hit) << "there is certainly no hit";
        // A walk goes on with this bound: what it then rejects lies behind, this one does not.
        const auto rest = claims(leaf, filter, t);
        for (std::size_t j = 0; j < rest.size(); ++j)
          ASSERT_TRUE(rest[j].candidate || truth[j] > t) << "a nearer hit is rejected";
      }
      if (claim.known && t != no_hit) {
        ASSERT_LE(claim.low, t);
        ASSERT_GE(claim.high, t);
      }
      if (exactly && claim.known) {
        const auto o = reference::units(ray.origin), d = reference::units(ray.direction),
                   a = reference::units(triangle.a), b = reference::units(triangle.b),
                   c = reference::units(triangle.c);
        const auto normal = cross(b - a, c - a);
        reference::Integer det = dot(d, normal), height = dot(a - o, normal);
        if (det < 0) det = -det, height = -height;
        ASSERT_TRUE(is_near(claim.det, claim.det_error, det));
        ASSERT_TRUE(is_near(claim.height, claim.height_error, height));
      }
      candidates_ += claim.candidate;
      certain_ += claim.certain;
      hits_ += t != no_hit && t <= tmax;
    }
  }

  int hits_ = 0, candidates_ = 0, certain_ = 0;
};

INSTANTIATE_TEST_SUITE_P(AllTargets, TriangleBlock, testing::ValuesIn(testers()),
                         [](const auto& test) { return test.param->isa; });

TEST_P(TriangleBlock, ClaimsOnlyWhatIsTrue) {
  for (const auto style : adversary::styles) {
    Random random(21, unsigned(style));
    for (int i = 0; i < 6000; ++i) {
      std::vector<Triangle> triangles(1 + random.below(20));
      for (Triangle& triangle : triangles) triangle = some_triangle(random, style);
      const Leaf leaf(std::move(triangles));
      const Triangle& target =
          leaf.triangles[random.below(static_cast<std::uint32_t>(leaf.triangles.size()))];
      const bool exactly = i % 32 == 0;
      for (int j = 0; j < 4; ++j) {
        Ray ray = some_ray(random, style, target);
        const float t = decide(ray, target);
        adversary::tempt_interval(random, ray, t);
        const float tmax = random.below(2) == 0 || t == no_hit ? no_hit : t;
        ASSERT_NO_FATAL_FAILURE(expect_true_claims(leaf, ray, tmax, exactly))
            << "style " << int(style) << ", round " << i;
      }
    }
  }
}

TEST_P(TriangleBlock, ClaimsOnlyWhatIsTrueOfCloseCalls) {
  Random random(22);
  for (int i = 0; i < 20000; ++i) {
    auto [ray, triangles] = close_call(random);
    const Leaf leaf(std::move(triangles));
    const float t = decide(ray, leaf.triangles[0]);
    adversary::tempt_interval(random, ray, t);
    ASSERT_NO_FATAL_FAILURE(expect_true_claims(leaf, ray, no_hit, i % 64 == 0)) << "round " << i;
  }
}

TEST_P(TriangleBlock, LeavesLittleToDecide) {
  Random random(23);
  for (int i = 0; i < 10000; ++i) {
    std::vector<Triangle> triangles(16);
    for (Triangle& triangle : triangles) triangle = adversary::triangle(random, adversary::Style::natural);
    const Vec3 origin = adversary::point(random, adversary::Style::natural);
    const Vec3 direction = adversary::point(random, adversary::Style::natural);
    ASSERT_NO_FATAL_FAILURE(expect_true_claims(Leaf(std::move(triangles)), {origin, 0, direction}, no_hit));
  }
  EXPECT_LT(candidates_, 1.001 * hits_);
  EXPECT_GT(certain_, 0.999 * hits_);
}

}  // namespace
}  // namespace raymeter
#endif
