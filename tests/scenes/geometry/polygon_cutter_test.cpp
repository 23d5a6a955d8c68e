#include "scenes/geometry/polygon_cutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scenes/base/random.h"

namespace raymeter {
namespace {

/// Corners on whole coordinates, so that all areas are exact.
using Outline = std::vector<std::array<int, 2>>;

std::vector<Vec3> in_plane(const Outline& outline, int axis) {
  std::vector<Vec3> corners;
  for (const auto& [x, y] : outline) {
    Vec3 corner;
    corner[axis] = 7;
    corner[(axis + 1) % 3] = static_cast<float>(x);
    corner[(axis + 2) % 3] = static_cast<float>(y);
    corners.push_back(corner);
  }
  return corners;
}

double doubled_area_of(const Outline& outline) {
  double sum = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto& [x, y] = outline[i];
    const auto& [next_x, next_y] = outline[(i + 1) % outline.size()];
    sum += double(x) * next_y - double(next_x) * y;
  }
  return std::abs(sum);
}

/// The triangles tile the outline: n - 2 of them, none turned over, and their areas add up to its area.
void expect_tiled(const Outline& outline) {
  PolygonCutter cutter;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Vec3> corners = in_plane(outline, axis);
    ASSERT_TRUE(cutter.cut(corners));
    ASSERT_EQ(cutter.triangles().size(), outline.size() - 2);
    double area = 0;
    for (const auto& [a, b, c] : cutter.triangles())
      area += length(cross(to_double(corners[b]) - to_double(corners[a]),
                           to_double(corners[c]) - to_double(corners[a])));
    EXPECT_EQ(area, doubled_area_of(outline));
  }
}

Outline reversed(Outline outline) {
  std::ranges::reverse(outline);
  return outline;
}

TEST(PolygonCutter, tiles_outlines) {
  const std::vector<Outline> outlines{
      {{0, 0}, {4, 0}, {0, 4}},
      {{0, 0}, {4, 0}, {4, 4}, {0, 4}},
      {{0, 0}, {4, 0}, {1, 1}, {0, 4}},                                                  // dart
      {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 4}, {0, 4}, {0, 2}},                          // straight corners
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},                                  // L
      {{0, 0}, {6, 0}, {6, 4}, {4, 4}, {4, 2}, {2, 2}, {2, 4}, {0, 4}},                  // U
      {{0, 0}, {8, 0}, {8, 8}, {2, 8}, {2, 4}, {4, 4}, {4, 6}, {6, 6}, {6, 2}, {0, 2}},  // spiral
      {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}},  // hole by a keyhole
      {{0, 0}, {0, 0}, {4, 0}, {4, 4}, {4, 4}, {1, 3}, {0, 4}},                          // doubled corners
  };
  for (const Outline& outline : outlines) {
    for (std::size_t turn = 0; turn < outline.size(); ++turn) {
      Outline turned = outline;
      std::ranges::rotate(turned, turned.begin() + static_cast<std::ptrdiff_t>(turn));
      expect_tiled(turned);
      expect_tiled(reversed(turned));
    }
  }
}

TEST(PolygonCutter, tiles_combs_and_gears) {
  Outline comb{{0, 0}, {1000, 0}};
  for (int tooth = 50; tooth-- > 0;) {
    comb.push_back({20 * tooth + 11, 900 + tooth % 7});
    comb.push_back({20 * tooth, 10});
  }
  expect_tiled(comb);
  // A gear's 144 corners: 36 teeth on a square's border.
  Outline gear;
  const int side[4][4] = {{1, 0, 0, -1}, {0, 1, 1, 0}, {-1, 0, 0, 1}, {0, -1, -1, 0}};
  int x = 0, y = 0;
  for (const auto& [dx, dy, out_x, out_y] : side)
    for (int tooth = 0; tooth < 9; ++tooth) {
      gear.push_back({x, y});
      gear.push_back({x + 4 * dx + 3 * out_x, y + 4 * dy + 3 * out_y});
      gear.push_back({x + 8 * dx + 3 * out_x, y + 8 * dy + 3 * out_y});
      gear.push_back({x + 12 * dx, y + 12 * dy});
      x += 16 * dx;
      y += 16 * dy;
    }
  ASSERT_EQ(gear.size(), 144u);
  expect_tiled(gear);
  expect_tiled(reversed(gear));
}

TEST(PolygonCutter, tiles_random_simple_outlines) {
  // Monotone chains above and below a line: simple by construction, with many reflex corners.
  Random random(11);
  for (int round = 0; round < 300; ++round) {
    Outline outline;
    const int n = 2 + static_cast<int>(random.below(30));
    for (int i = 0; i <= n; ++i) outline.push_back({i * 3, -static_cast<int>(random.below(100)) - 1});
    for (int i = n; i >= 0; --i) outline.push_back({i * 3, static_cast<int>(random.below(100))});
    std::ranges::rotate(outline, outline.begin() + random.below(static_cast<std::uint32_t>(outline.size())));
    expect_tiled(outline);
    expect_tiled(reversed(outline));
  }
}

TEST(PolygonCutter, signs_are_exact) {
  // The reflex corner is off the diagonal by the last bit of a coordinate far from the origin.
  const float far = 16777216, step = 2;
  const std::vector<Vec3> corners{{far, 0, 0}, {far + 8 * step, 8, 0}, {far + 4 * step, 4, 0}, {far, 8, 0}};
  PolygonCutter cutter;
  ASSERT_TRUE(cutter.cut(corners));
  EXPECT_EQ(cutter.triangles().size(), 2u);
  const float tiny = 1e-30f, one = 1 + 0x1p-23f;
  const std::vector<Vec3> sliver{{tiny, tiny, 0}, {one, 1, 0}, {2 * one, 2, 0}, {tiny, one, 0}};
  ASSERT_TRUE(cutter.cut(sliver));
  EXPECT_EQ(cutter.triangles().size(), 2u);
}

TEST(PolygonCutter, ends_for_any_corners) {
  Random random(5);
  PolygonCutter cutter;
  for (int round = 0; round < 2000; ++round) {
    std::vector<Vec3> corners(3 + random.below(40));
    for (Vec3& corner : corners)
      for (int axis = 0; axis < 3; ++axis)
        corner[axis] = static_cast<float>(random.below(5)) * (round % 2 ? 1 : 1e38f / 4);
    ASSERT_TRUE(cutter.cut(corners));
    ASSERT_EQ(cutter.triangles().size(), corners.size() - 2);
  }
}

TEST(PolygonCutter, large_polygons) {
  PolygonCutter cutter;
  std::vector<Vec3> parabola;
  for (int i = 0; i < 300000; ++i)
    parabola.push_back({static_cast<float>(i), static_cast<float>(i) * static_cast<float>(i), 0});
  ASSERT_TRUE(cutter.cut(parabola));
  EXPECT_EQ(cutter.triangles().size(), parabola.size() - 2);

  std::vector<Vec3> zigzag{{0, -5, 0}};
  for (int i = 0; i < 8190; ++i) zigzag.push_back({static_cast<float>(i), static_cast<float>(i % 2), 0});
  ASSERT_TRUE(cutter.cut(zigzag));
  EXPECT_EQ(cutter.triangles().size(), zigzag.size() - 2);
  zigzag.resize(2 * zigzag.size(), {8200, 1, 0});
  EXPECT_FALSE(cutter.cut(zigzag));
}

}  // namespace
}  // namespace raymeter
