#include "accel/grid_resolution.h"

#include <gtest/gtest.h>

namespace raymeter {
namespace {

using Kind = ResolutionRule::Kind;

Resolution choose(const ResolutionRule& rule, const ShapeSizes& shapes) {
  const auto chosen = choose_resolution(rule, shapes, {});
  EXPECT_EQ(chosen.note, "");
  return chosen.n;
}

TEST(GridResolution, AmountIsExtentOverMeanExtent) {
  const ShapeSizes shapes{1000, {10, 6, 2}, {1, 0.8, 3}};
  EXPECT_EQ(choose({Kind::amount, 1}, shapes), (Resolution{10, 8, 1}));   // 10, 7.5, 0.67
  EXPECT_EQ(choose({Kind::amount, 2}, shapes), (Resolution{20, 15, 1}));  // 20, 15, 1.33
  EXPECT_EQ(choose({Kind::amount, 0.5}, shapes), (Resolution{5, 4, 1}));  // 5, 3.75, 0.33
  EXPECT_EQ(choose(resolution_rule("paper"), shapes), (Resolution{10, 8, 1}));
}

TEST(GridResolution, DensityMakesCubes) {
  // V = 1000: for lambda N = 8000 the cells' edge is 0.5.
  const ShapeSizes shapes{2000, {40, 5, 5}, {1, 1, 1}};
  EXPECT_EQ(choose({Kind::density, 4}, shapes), (Resolution{80, 10, 10}));
  EXPECT_EQ(choose(resolution_rule("rayshade"), shapes), (Resolution{50, 6, 6}));   // 1.26 a unit: 50.4, 6.3
  EXPECT_EQ(choose(resolution_rule("havran"), shapes), (Resolution{73, 9, 9}));     // 1.817: 72.7, 9.09
  EXPECT_EQ(choose(resolution_rule("wald"), shapes), (Resolution{86, 11, 11}));     // 2.154: 86.2, 10.8
  EXPECT_EQ(choose(resolution_rule("kalojanov"), shapes), (Resolution{25, 3, 3}));  // 0.6214: 24.9, 3.1
}

TEST(GridResolution, PbrtCapsAt64) {
  EXPECT_EQ(choose(resolution_rule("pbrt"), {1000, {10, 5, 1}, {}}), (Resolution{30, 15, 3}));  // 3 * 10
  EXPECT_EQ(choose(resolution_rule("pbrt"), {1000000, {10, 5, 1}, {}}), (Resolution{64, 64, 30}));
}

TEST(GridResolution, FlatScenes) {
  EXPECT_EQ(choose({Kind::density, 4}, {100, {10, 10, 0}, {1, 1, 0}}), (Resolution{20, 20, 1}));
  EXPECT_EQ(choose({Kind::density, 4}, {100, {0, 10, 0}, {0, 1, 0}}), (Resolution{1, 400, 1}));
  EXPECT_EQ(choose({Kind::density, 4}, {1, {0, 0, 0}, {0, 0, 0}}), (Resolution{1, 1, 1}));
  EXPECT_EQ(choose({Kind::density, 4}, {0, {0, 0, 0}, {0, 0, 0}}), (Resolution{1, 1, 1}));
  EXPECT_EQ(choose({Kind::amount, 1}, {100, {10, 10, 0}, {1, 1, 0}}), (Resolution{10, 10, 1}));
  EXPECT_EQ(choose(resolution_rule("pbrt"), {1, {0, 0, 0}, {0, 0, 0}}), (Resolution{1, 1, 1}));

  // A sheet of paper: the formula's cubes are thicker than it, and would be 10 * (400 / 0.01)^(1/3) = 342 a
  // side.
  auto chosen = choose_resolution({Kind::density, 4}, {100, {10, 10, 1e-4}, {1, 1, 0}}, {});
  EXPECT_EQ(chosen.n, (Resolution{20, 20, 1}));
  EXPECT_EQ(chosen.note, "thin along z: 1 cell there");
  // Shelves: flat shapes at different heights.
  chosen = choose_resolution({Kind::amount, 1}, {1000, {10, 10, 5}, {1, 1, 0}}, {});
  EXPECT_EQ(chosen.n, (Resolution{10, 10, 10}));
  EXPECT_EQ(chosen.note, "all shapes are flat along z: 10 cells there");
}

TEST(GridResolution, ClampsAloud) {
  const ShapeSizes shapes{1000, {1, 1, 1}, {1e-4, 0.01, 0.1}};
  auto chosen = choose_resolution({Kind::amount, 1}, shapes, {});
  EXPECT_EQ(chosen.n, (Resolution{4096, 100, 10}));
  EXPECT_EQ(chosen.note, "clamped from 10000x100x10 to 4096x100x10 (limit 4096 along an axis)");
  EXPECT_TRUE(chosen.clamped);

  // 4.1 million cells to a thousand: each axis by the same factor.
  chosen = choose_resolution({Kind::amount, 1}, shapes, {.per_axis = 4096, .cells = 1000});
  EXPECT_LE(cell_count(chosen.n), 1000u);
  EXPECT_GE(cell_count(chosen.n), 500u);  // x 1/20, floored: 204.8, 4.99, 0.5
  EXPECT_EQ(chosen.note, "clamped from 10000x100x10 to 204x4x1 (limit 4096 along an axis; 1000 cells)");

  chosen =
      choose_resolution({Kind::cells, 0, {10, 10, 10}}, {1, {1, 1, 1e-3}, {1, 1, 1}}, {.thinnest = 2.5e-4});
  EXPECT_EQ(chosen.n, (Resolution{10, 10, 4}));
  EXPECT_EQ(chosen.note, "clamped from 10x10x10 to 10x10x4 (limit cells along z no thinner than 0.00025)");
}

}  // namespace
}  // namespace raymeter
