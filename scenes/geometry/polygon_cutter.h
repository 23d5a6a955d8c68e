#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// Cuts polygons into triangles. Keeps its scratch memory between polygons.
class PolygonCutter {
 public:
  /// Polygons that need ear clipping, whose time is quadratic, may have so many corners.
  static constexpr std::size_t most_clipped_corners = 8192;

  /// Cuts a polygon of n >= 3 corners into n - 2 triangles without new vertices. Where the polygon is simple
  /// in the plane dropped along the largest component of its normal (Newell's), they tile it: a fan from the
  /// first corner when that does (all convex polygons), in linear time, else ears are clipped (Meisters 1975;
  /// the bookkeeping is O'Rourke's, Computational Geometry in C, 1998). Orientations are exact. Of any other
  /// polygon the triangles are some n - 2 triangles. Returns false, having done nothing, for one that needs
  /// clipping and has more than most_clipped_corners.
  bool cut(std::span<const Vec3> corners);

  /// Of the last cut: positions in `corners`, in its sense of rotation.
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }

 private:
  struct Point {
    float x, y;
    friend bool operator==(const Point&, const Point&) = default;
  };
  static int orientation(const Point& a, const Point& b, const Point& c);

  bool fan_tiles() const;
  void clip_ears(int sense);
  bool is_ear(std::uint32_t corner, int sense) const;
  void classify(std::uint32_t corner, int sense);
  std::uint32_t find_ear(std::uint32_t start, std::size_t remaining) const;

  std::vector<Point> points_;
  std::vector<std::uint32_t> previous_, next_;  ///< the corners not yet cut off, as a ring
  std::vector<std::int8_t> turn_;               ///< 1 convex, 0 straight or turning back, -1 reflex
  std::vector<std::uint8_t> ear_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace raymeter
