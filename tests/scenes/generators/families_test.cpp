// The families with one knob each: that the knob does what it says.
#include "scenes/generators/families.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

double area(const Triangle& t) {
  const Vec3d normal = cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a));
  return 0.5 * std::sqrt(dot(normal, normal));
}

double mean_area(const Scene& scene) {
  double sum = 0;
  for (std::uint32_t i = 0; i < scene.triangle_count(); ++i) sum += area(scene.triangle(i));
  return sum / static_cast<double>(scene.triangle_count());
}

TEST(Families, ScenesAreTheSameOnEveryMachine) {
  EXPECT_EQ(open_scene("crowding:triangles=1000:seed=3").hash(), 10043439659760566415u);
  EXPECT_EQ(open_scene("sizes:triangles=1000:seed=3").hash(), 595739581896601761u);
  EXPECT_EQ(open_scene("slivers:triangles=1000:seed=3").hash(), 29758205992420777u);
  EXPECT_EQ(open_scene("stadium:triangles=1000").hash(), 3333663983698529097u);
  EXPECT_EQ(open_scene("two-scales:triangles=1000:seed=3").hash(), 3434488618328023260u);
}

TEST(Families, CountsAreThoseAskedFor) {
  for (const char* name : {"crowding", "sizes", "slivers", "two-scales"}) {
    EXPECT_EQ(open_scene(std::string(name) + ":triangles=1001").triangle_count(), 1001u) << name;
    EXPECT_NE(open_scene(std::string(name) + ":triangles=1001").hash(),
              open_scene(std::string(name) + ":triangles=1001:seed=2").hash());
  }
  for (const double wanted : {1000.0, 60000.0})
    EXPECT_NEAR(
        static_cast<double>(open_scene("stadium:triangles=" + std::to_string(wanted)).triangle_count()),
        wanted, 0.02 * wanted);
  EXPECT_EQ(open_scene("stadium:triangles=20").triangle_count(), 2u * 3 * 3 + 2);
}

TEST(Families, LimitsAreKept) {
  for (const char* name : {"crowding:kappa=0", "crowding:kappa=1.5", "crowding:triangles=8", "sizes:sigma=-1",
                           "sizes:sigma=3", "slivers:aspect=0.5", "stadium:ratio=0.5", "stadium:triangles=2",
                           "two-scales:ratio=0", "sizes:size=nan", "two-scales:triangles=1"})
    EXPECT_THROW(open_scene(name), Error) << name;
}

TEST(Crowding, KeepsItsBoxAndFillsTheCubeOfKappa) {
  for (const double kappa : {1.0, 0.3, 0.01}) {
    const Scene scene = open_scene("crowding:triangles=20008:size=0.01:kappa=" + std::to_string(kappa));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(scene.bounds().low[axis], 0, 0.0101 * kappa);
      EXPECT_NEAR(scene.bounds().high[axis], 1, 0.0101 * kappa);
    }
    // The first 20,000 lie in the cube, evenly: as many in each of its octants.
    std::array<int, 8> octants{};
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const Bounds box = scene.bounds_of(i);
      std::size_t octant = 0;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(std::max(0.5 - box.low[axis], box.high[axis] - 0.5), (0.5 + 0.0101) * kappa);
        octant = 2 * octant + (double(box.low[axis]) + box.high[axis] > 1);
      }
      ++octants[octant];
    }
    for (const int count : octants) EXPECT_NEAR(count, 2500, 250);
    // They shrink with their cube: all cubes are alike.
    EXPECT_NEAR(mean_area(scene) / (kappa * kappa),
                mean_area(open_scene("crowding:triangles=20008:size=0.01:kappa=1")),
                2e-3 * mean_area(scene) / (kappa * kappa));
  }
}

TEST(Sizes, SpreadIsThatOfTheKnobAndTheMeanAreaStays) {
  const double expected = mean_area(open_scene("sizes:triangles=100000:sigma=0:size=0.004"));
  for (const double sigma : {0.5, 1.0}) {
    const Scene scene = open_scene("sizes:triangles=100000:size=0.004:sigma=" + std::to_string(sigma));
    EXPECT_NEAR(mean_area(scene), expected, 0.1 * expected) << sigma;
    // log(area) = 2 log(reach) + log(shape): the spread of shapes is that at sigma = 0.
    const auto spread = [](const Scene& s) {
      double sum = 0, squares = 0;
      for (std::uint32_t i = 0; i < s.triangle_count(); ++i) {
        const double x = std::log(area(s.triangle(i)));
        sum += x, squares += x * x;
      }
      const auto n = static_cast<double>(s.triangle_count());
      return squares / n - sum / n * sum / n;
    };
    const double shapes = spread(open_scene("sizes:triangles=100000:sigma=0:size=0.004"));
    EXPECT_NEAR(std::sqrt((spread(scene) - shapes) / 4), sigma, 0.03);
  }
}

TEST(Slivers, AreOfTheAspectAndTheAreaAskedForAtAllAngles) {
  for (const double aspect : {1.0, 100.0, 2000.0}) {
    const Scene scene = open_scene("slivers:triangles=3000:area=0.001:aspect=" + std::to_string(aspect));
    std::array<double, 3> along{};
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const Triangle t = scene.triangle(i);
      const Vec3d base = to_double(t.b) - to_double(t.a);
      EXPECT_NEAR(area(t), 0.001, 1e-3 * 0.001 * std::sqrt(aspect));
      EXPECT_NEAR(length(base) * length(base) / (2 * area(t)), aspect, 2e-3 * aspect * std::sqrt(aspect));
      for (int axis = 0; axis < 3; ++axis)
        along[std::size_t(axis)] += base[axis] * base[axis] / dot(base, base) / 3000;
    }
    for (const double part : along) EXPECT_NEAR(part, 1 / 3.0, 0.02);  // of cos^2: isotropic
  }
}

TEST(Stadium, GroundIsAsManyTimesWiderAsAskedFor) {
  for (const double ratio : {10.0, 1000.0}) {
    const Scene scene = open_scene("stadium:triangles=5000:ratio=" + std::to_string(ratio));
    Bounds knot;
    for (std::uint32_t i = 0; i + 2 < scene.triangle_count(); ++i) {
      const Bounds box = scene.bounds_of(i);
      knot.extend(box.low);
      knot.extend(box.high);
      EXPECT_GT(area(scene.triangle(i)), 0);
    }
    EXPECT_NEAR(scene.bounds().extent().x / knot.extent().x, ratio, 1e-4 * ratio);
    EXPECT_GT(knot.low.z, 0);  // it stands above the ground
    EXPECT_LT(knot.low.z, 0.1f);
  }
}

TEST(Stadium, KnotIsClosed) {
  // Every edge of the mesh belongs to two triangles, which run along it in opposite directions.
  const Scene scene = open_scene("stadium:triangles=2000");
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::uint32_t i = 0; i + 2 < scene.triangle_count(); ++i)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{scene.triangles()[i][k], scene.triangles()[i][(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(TwoScales, OneSoupIsTheOtherShrunk) {
  for (const double ratio : {1.0, 50.0}) {
    const Scene scene = open_scene("two-scales:triangles=20000:ratio=" + std::to_string(ratio));
    double large = 0, small = 0;
    for (std::uint32_t i = 0; i < 10000; ++i) {
      large += area(scene.triangle(i));
      small += area(scene.triangle(10000 + i));
      EXPECT_LT(scene.bounds_of(i).high.x, 1.03f);
      EXPECT_GT(scene.bounds_of(10000 + i).low.x, 1 + 0.97 / ratio - 0.03);
    }
    EXPECT_NEAR(std::sqrt(large / small), ratio, 0.02 * ratio);
  }
}

}  // namespace
}  // namespace raymeter
