#include "accel/brick_overlap.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/base/float_mode.h"
#include "scenes/base/random.h"
#include "scenes/geometry/exact.h"
#include "scenes/geometry/rounding.h"
#include "tests/scenes/geometry/adversary.h"

namespace raymeter {
namespace {

using ExactVec3 = Vector3<ExactInteger>;

/// Exactly whether a triangle, degenerate or not, and a cell of a brick that is grown on each axis have a
/// point in common.
bool meet_exactly(const Triangle& triangle, const BrickNode& node, int cell, const Vec3& growth) {
  ExactUnit unit;
  const Vec3 node_low{node.low[0], node.low[1], node.low[2]}, size{node.size[0], node.size[1], node.size[2]};
  for (const Vec3& v : {triangle.a, triangle.b, triangle.c, node_low, size, growth}) unit.admit(v);
  const std::array<ExactVec3, 3> corners{unit(triangle.a), unit(triangle.b), unit(triangle.c)};
  const std::array<int, 3> at{cell % 4, cell / 4 % 4, cell / 16};
  ExactVec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = unit(node_low[axis]) + at[static_cast<std::size_t>(axis)] * unit(size[axis]);
    high[axis] = low[axis] + unit(size[axis]) + unit(growth[axis]);
    low[axis] -= unit(growth[axis]);
  }
  const auto separates = [&](const ExactVec3& axis) {
    ExactInteger box_low = 0, box_high = 0;
    for (int i = 0; i < 3; ++i) {
      const ExactInteger a = axis[i] * low[i], b = axis[i] * high[i];
      box_low += std::min(a, b);
      box_high += std::max(a, b);
    }
    const std::array<ExactInteger, 3> along{dot(axis, corners[0]), dot(axis, corners[1]),
                                            dot(axis, corners[2])};
    return std::ranges::max(along) < box_low || std::ranges::min(along) > box_high;
  };
  const std::array<ExactVec3, 3> units{ExactVec3{1, 0, 0}, ExactVec3{0, 1, 0}, ExactVec3{0, 0, 1}};
  for (const ExactVec3& axis : units)
    if (separates(axis)) return false;
  for (std::size_t c = 0; c < 3; ++c)
    for (const ExactVec3& axis : units)
      if (separates(cross(corners[(c + 1) % 3] - corners[c], axis))) return false;
  return !separates(cross(corners[1] - corners[0], corners[2] - corners[0]));
}

/// A brick with cells of about `size`, with its low corner about `offset` sizes from 0; now and then with an
/// axis that is not cut.
CutBrick random_brick(Random& random, float size, float offset) {
  CutBrick brick;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    brick.node.low[axis] = size * offset * random.uniform(-1, 1);
    brick.node.size[axis] = size * random.uniform(0.2f, 1);
    if (random.below(6) == 0) brick.layers[axis] = 1;
    // As the builder does: floats can tell the planes apart.
    brick.node.size[axis] = std::max(brick.node.size[axis], 0x1p-18f * std::abs(brick.node.low[axis]));
  }
  return brick;
}

enum class Style { ordinary, small, tiny, on_planes, sliver, needle, long_ones, far_apart, degenerate, flat };
constexpr Style styles[] = {Style::ordinary,   Style::small,  Style::tiny,      Style::on_planes,
                            Style::sliver,     Style::needle, Style::long_ones, Style::far_apart,
                            Style::degenerate, Style::flat};

class Triangles {
 public:
  Triangles(Random& random, const BrickNode& node) : random_(random), node_(node) {}

  Triangle make(Style style) {
    Triangle t{point(), point(), point()};
    const auto stretched = [&](const Vec3& from, const Vec3& to, float factor) {
      Vec3 v;
      for (int axis = 0; axis < 3; ++axis) v[axis] = from[axis] + factor * (to[axis] - from[axis]);
      return v;
    };
    switch (style) {
      case Style::ordinary:
        break;
      case Style::small:
        t.b = stretched(t.a, t.b, 0.2f);
        t.c = stretched(t.a, t.c, 0.2f);
        break;
      case Style::tiny: {  // about a corner of a cell, as far as floats allow, or until products underflow
        const auto smallness = static_cast<int>(random_.below(80));
        for (int axis = 0; axis < 3; ++axis) {
          const float at = random_.below(2) == 0 ? node_.low[static_cast<std::size_t>(axis)] : plane(axis);
          for (Vec3* v : {&t.a, &t.b, &t.c})
            (*v)[axis] =
                flushed(at + std::ldexp(random_.uniform(-1, 1) * node_.size[static_cast<std::size_t>(axis)],
                                        -smallness - static_cast<int>(random_.below(20))));
        }
        break;
      }
      case Style::on_planes:
        for (Vec3* v : {&t.a, &t.b, &t.c})
          for (int axis = 0; axis < 3; ++axis)
            if (random_.below(3) != 0) (*v)[axis] = plane(axis);
        break;
      case Style::sliver:
        t.c = stretched(t.a, t.b, random_.uniform(-1, 2));
        t.c[static_cast<int>(random_.below(3))] *= 1.0000002f;
        break;
      case Style::needle: {
        const Vec3 middle = t.a;
        t.a = stretched(middle, t.b, 1e4f);
        t.b = stretched(middle, t.b, -1e4f);
        t.c = {std::nextafter(t.b.x, 1e38f), t.b.y, std::nextafter(t.b.z, -1e38f)};
        break;
      }
      case Style::long_ones: {
        const Vec3 inside = point();
        for (Vec3* v : {&t.a, &t.b, &t.c})
          *v = stretched(inside, *v, std::ldexp(1.0f, static_cast<int>(random_.below(20))));
        break;
      }
      case Style::far_apart: {  // one corner at hand
        t.b = stretched(t.a, t.b, 1e6f);
        t.c = stretched(t.a, t.c, -1e5f);
        break;
      }
      case Style::degenerate:
        t.c = random_.below(2) == 0 ? t.a : t.b;
        if (random_.below(2) == 0) t.b = t.a;
        break;
      case Style::flat: {
        const auto axis = static_cast<int>(random_.below(3));
        t.b[axis] = t.c[axis] = t.a[axis];
        break;
      }
    }
    return t;
  }

 private:
  float plane(int axis) { return static_cast<float>(node_.plane(axis, static_cast<int>(random_.below(5)))); }
  /// In or near by the brick.
  Vec3 point() {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis)
      v[axis] = node_.low[static_cast<std::size_t>(axis)] +
                node_.size[static_cast<std::size_t>(axis)] * random_.uniform(-1, 5);
    return v;
  }

  Random& random_;
  const BrickNode& node_;
};

/// Triangles in columns.
class Columns {
 public:
  explicit Columns(const std::vector<Triangle>& triangles)
      : count_(triangles.size()),
        stride_((count_ + widest_vector - 1) / widest_vector * widest_vector),
        rows_(9 * stride_, std::numeric_limits<float>::quiet_NaN()) {
    for (std::size_t i = 0; i < count_; ++i) {
      std::size_t row = 0;
      for (const Vec3& v : {triangles[i].a, triangles[i].b, triangles[i].c})
        for (int axis = 0; axis < 3; ++axis) rows_[stride_ * row++ + i] = v[axis];
    }
  }
  operator TriangleColumns() const { return {rows_.data(), stride_, count_}; }

 private:
  std::size_t count_, stride_;
  std::vector<float> rows_;
};

/// The masks of each instruction set, which must be equal.
std::vector<std::uint64_t> cells_of(const CutBrick& brick, const std::vector<Triangle>& triangles) {
  const Columns columns(triangles);
  std::vector<std::uint64_t> first;
  for (const BrickOverlap& overlap : brick_overlaps()) {
    std::vector<std::uint64_t> cells(triangles.size());
    overlap.cells_of(brick, columns, cells.data());
    if (first.empty()) first = cells;
    EXPECT_EQ(cells, first) << overlap.isa;
  }
  return first;
}

double magnitude_of(const CutBrick& brick, const std::vector<Triangle>& triangles) {
  double magnitude = 0;
  for (int axis = 0; axis < 3; ++axis) {
    magnitude = std::max({magnitude, std::abs(double(brick.node.plane(axis, 0))),
                          std::abs(double(brick.node.plane(axis, 4)))});
    for (const Triangle& t : triangles)
      for (const Vec3& v : {t.a, t.b, t.c}) magnitude = std::max(magnitude, std::abs(double(v[axis])));
  }
  return magnitude;
}

/// Every cell that is met, and few others.
void expect_right(const CutBrick& brick, const std::vector<Triangle>& triangles, const std::string& what) {
  Vec3 more;
  for (int axis = 0; axis < 3; ++axis)
    more[axis] = static_cast<float>(4 * brick.slack(axis)) +
                 0x1p-16f * brick.node.size[static_cast<std::size_t>(axis)];
  const std::vector<std::uint64_t> masks = cells_of(brick, triangles);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int cell = 0; cell < 64; ++cell) {
      const bool met = (masks[i] >> cell & 1u) != 0;
      if (cell % 4 >= brick.layers[0] || cell / 4 % 4 >= brick.layers[1] || cell / 16 >= brick.layers[2]) {
        ASSERT_FALSE(met);
        continue;
      }
      if (met) {
        ASSERT_TRUE(meet_exactly(triangles[i], brick.node, cell, more))
            << what << " triangle " << i << " cell " << cell;
      } else {
        ASSERT_FALSE(meet_exactly(triangles[i], brick.node, cell, {}))
            << what << " triangle " << i << " cell " << cell;
      }
    }
}

TEST(BrickOverlap, HasEveryCellThatIsMetAndFewOthers) {
  const FlushDenormals mode;
  Random random(5);
  for (const float size : {1e-12f, 1e-3f, 1.0f, 700.0f, 1e12f})
    for (const float offset : {0.0f, 0.5f, 10.0f, 3000.0f, 2e5f})
      for (const Style style : styles)
        for (int round = 0; round < 5; ++round) {
          CutBrick brick = random_brick(random, size, offset);
          std::vector<Triangle> triangles;
          Triangles source(random, brick.node);
          for (int i = 0; i < 27; ++i) triangles.push_back(source.make(style));
          brick.margin = 0x1p-40 * magnitude_of(brick, triangles);
          expect_right(brick, triangles, fmt::format("size {} offset {} style {}", size, offset, int(style)));
        }
}

TEST(BrickOverlap, HasEveryCellThatAnAdversarysTriangleMeets) {
  const FlushDenormals mode;
  for (const auto style : adversary::styles) {
    Random random(8, unsigned(style));
    for (int round = 0; round < 100; ++round) {
      std::vector<Triangle> triangles;
      Bounds bounds;
      for (std::uint32_t i = 0; i < 1 + random.below(9); ++i) {
        Triangle& t = triangles.emplace_back(adversary::triangle(random, style));
        for (Vec3* v : {&t.a, &t.b, &t.c})
          for (int axis = 0; axis < 3; ++axis) (*v)[axis] = flushed(std::clamp((*v)[axis], -1e36f, 1e36f));
        bounds.extend(bounds_of(t));
      }
      // As the builder does.
      CutBrick brick;
      brick.margin = std::max(0x1p-40 * magnitude_of(brick, triangles), 0x1p-100);
      const Vec3d extent = bounds.extent();
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double high = bounds.high[axis] + brick.margin;
        if (extent[axis] < std::max({extent.x, extent.y, extent.z}) / 64) brick.layers[a] = 1;
        brick.node.low[a] = float_below(bounds.low[axis] - brick.margin);
        brick.node.size[a] = -float_below(-(high - double(brick.node.low[a])) / brick.layers[a]);
      }
      expect_right(brick, triangles, fmt::format("style {} round {}", int(style), round));
    }
  }
}

TEST(BrickOverlap, BoxesOfTriangles) {
  Random random(6);
  const CutBrick brick = random_brick(random, 1, 10);
  Triangles source(random, brick.node);
  for (std::size_t count = 1; count < 40; ++count) {
    std::vector<Triangle> triangles;
    Bounds expected;
    for (std::size_t i = 0; i < count; ++i) {
      triangles.push_back(source.make(Style::ordinary));
      expected.extend(bounds_of(triangles.back()));
    }
    for (const BrickOverlap& overlap : brick_overlaps()) {
      const Bounds box = overlap.bounds_of(Columns(triangles));
      EXPECT_EQ(box.low, expected.low) << overlap.isa << ' ' << count;
      EXPECT_EQ(box.high, expected.high) << overlap.isa << ' ' << count;
    }
  }
}

TEST(BrickOverlap, CountsBits) {
  Random random(7);
  std::vector<std::uint64_t> masks(1000);  // of which most have bit 5
  std::array<std::uint32_t, 64> expected{};
  expected.fill(3);
  for (std::uint64_t& mask : masks) {
    mask = std::uint64_t{random.bits()} << 32 | random.bits();
    if (random.below(20) != 0) mask |= 1u << 5;
    for (std::size_t i = 0; i < 64; ++i) expected[i] += static_cast<std::uint32_t>(mask >> i & 1u);
  }
  for (const BrickOverlap& overlap : brick_overlaps()) {
    std::array<std::uint32_t, 64> counts{};
    counts.fill(3);
    overlap.count_bits(masks, counts);
    EXPECT_EQ(counts, expected) << overlap.isa;
  }
}

}  // namespace
}  // namespace raymeter
