#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "scenes/geometry/filter.h"
#include "scenes/geometry/primitives.h"

namespace raymeter {

/// Triangles side by side, for tests of many at once: rows of `count` floats, the corners a, b and c (x, y, z
/// each), then an edge, then the primitives' indices.
struct TriangleRows {
  static constexpr std::size_t rows = 11;
  static constexpr std::size_t edge_row = 9, index_row = 10;
  /// The edge is the greater 1-norm of b - a and c - a, rounded up, in this unit: products of it overflow
  /// before those of coordinates do.
  static constexpr float edge_unit = 32;

  const std::uint32_t* words = nullptr;
  std::uint32_t count = 0;

  const float* row(std::size_t i) const { return reinterpret_cast<const float*>(words) + i * count; }
  std::uint32_t primitive(std::uint32_t column) const { return words[index_row * count + column]; }
  float edge(std::uint32_t column) const { return row(edge_row)[column] * (1 / edge_unit); }
  Triangle triangle(std::uint32_t column) const {
    const float* at = row(0) + column;
    const auto next = [&] {
      const float number = *at;
      at += count;
      return number;
    };
    Triangle t;
    for (Vec3* v : {&t.a, &t.b, &t.c}) {
      v->x = next();
      v->y = next();
      v->z = next();
    }
    return t;
  }

  /// Writes a column of the rows that begin at `words`.
  static void put(std::uint32_t* words, std::size_t count, std::size_t column, const Triangle& triangle,
                  std::uint32_t primitive) {
    const auto put_float = [&](float number) {
      words[column] = std::bit_cast<std::uint32_t>(number);
      words += count;
    };
    for (const Vec3& v : {triangle.a, triangle.b, triangle.c}) {
      put_float(v.x);
      put_float(v.y);
      put_float(v.z);
    }
    const auto norm = [&](const Vec3& v) {
      return std::abs(double(v.x) - triangle.a.x) + std::abs(double(v.y) - triangle.a.y) +
             std::abs(double(v.z) - triangle.a.z);
    };
    put_float(static_cast<float>(edge_unit * (std::max(norm(triangle.b), norm(triangle.c)) + filter::tiny) *
                                 (1 + 0x1p-23)));
    words[column] = primitive;
  }
};

}  // namespace raymeter
