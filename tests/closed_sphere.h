#pragma once
// A closed mesh, and rays from inside it that no sound tracer lets out: at every vertex, at the middle of
// every edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "accel/structure.h"
#include "scenes/scene.h"

namespace raymeter {

/// A sphere of 39,600 triangles, 19,802 vertices and 59,400 edges, in a place of its own.
class ClosedSphere {
 public:
  /// Radius `scale` about `centre`; turned out of the axes, or with its poles on the z axis.
  explicit ClosedSphere(float scale = 1, Vec3 centre = {}, bool turned = false)
      : scale_(scale), centre_(centre), turned_(turned) {
    vertices_ = {place({0, 0, 1}), place({0, 0, -1})};
    for (std::uint32_t i = 1; i < stacks; ++i)
      for (std::uint32_t j = 0; j < slices; ++j) {
        const double polar = pi * i / stacks, around = 2 * pi * j / slices;
        vertices_.push_back(
            place({std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)}));
      }
    const auto index = [](std::uint32_t i, std::uint32_t j) {
      return i == 0 ? 0 : i == stacks ? 1 : 2 + (i - 1) * slices + j % slices;
    };
    for (std::uint32_t i = 0; i < stacks; ++i)
      for (std::uint32_t j = 0; j < slices; ++j) {
        const std::uint32_t a = index(i, j), b = index(i, j + 1), c = index(i + 1, j),
                            d = index(i + 1, j + 1);
        if (i > 0) triangles_.push_back({a, b, d});
        if (i < stacks - 1) triangles_.push_back({a, d, c});
      }
  }

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const std::array<std::uint32_t, 3>> triangles() const { return triangles_; }

  /// Pairs of indices into vertices(), the smaller first, each once.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges() const {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& [a, b, c] : triangles_)
      edges.insert({std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)});
    return {edges.begin(), edges.end()};
  }

  /// Well inside: the centre, on the line of the poles, and two other places.
  std::vector<Vec3> interior_points() const {
    return {place({0, 0, 0}), place({0, 0, 0.9}), place({0.1, -0.2, 0.3}), place({0.6, 0.6, -0.5})};
  }

  Vec3 middle_of(const std::pair<std::uint32_t, std::uint32_t>& edge) const {
    return 0.5f * vertices_[edge.first] + 0.5f * vertices_[edge.second];
  }

  Scene scene() const {
    SceneData data;
    data.name = "closed sphere";
    data.vertices = vertices_;
    data.triangles = triangles_;
    return Scene(std::move(data));
  }

 private:
  static constexpr std::uint32_t stacks = 100, slices = 200;
  static constexpr double pi = 3.14159265358979;

  /// A point of the unit sphere, turned by 1 radian about z and then about x, scaled and moved.
  Vec3 place(Vec3d p) const {
    const double c = std::cos(1.0), s = std::sin(1.0);
    if (turned_) {
      p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
      p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    }
    return to_float(to_double(centre_) + double(scale_) * p);
  }

  float scale_;
  Vec3 centre_;
  bool turned_;
  std::vector<Vec3> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// Aims from `origins` inside at every vertex (19,802 rays each) and at the middle of every edge (59,400):
/// all must hit, and near what they are aimed at.
inline void expect_watertight(const Structure& structure, const ClosedSphere& sphere,
                              std::span<const Vec3> origins, const std::string& what) {
  std::vector<Ray> at_vertices, at_edges;
  const auto edges = sphere.edges();
  for (const Vec3& origin : origins)
    for (const Vec3& vertex : sphere.vertices()) at_vertices.push_back({origin, 0, vertex - origin});
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Vec3& origin = origins[i % origins.size()];
    at_edges.push_back({origin, 0, sphere.middle_of(edges[i]) - origin});
  }
  ASSERT_EQ(at_vertices.size(), 19802 * origins.size());
  ASSERT_EQ(at_edges.size(), 59400u);

  const auto misses = [&](std::span<const Ray> rays) {
    std::vector<Hit> hits(rays.size());
    structure.trace_closest({rays}, hits);
    return std::ranges::count_if(hits, [](const Hit& hit) { return !(std::abs(hit.t - 1) < 0.01f); });
  };
  EXPECT_EQ(misses(at_vertices), 0) << what << ", at vertices";
  EXPECT_EQ(misses(at_edges), 0) << what << ", at edges";
  std::vector<std::uint8_t> occluded(at_vertices.size());
  structure.trace_any({at_vertices, QueryKind::any}, occluded);
  EXPECT_EQ(std::ranges::count(occluded, 0), 0) << what << ", any hit at vertices";
}

/// The sphere as it is, with rays from four points, and tiny, large, far from the origin and turned, with
/// rays from one point each. `build` makes the structure of a scene.
template <class Build>
void expect_watertight_everywhere(Build build) {
  const auto expect = [&](const ClosedSphere& sphere, std::size_t origins, const std::string& what) {
    const Scene scene = sphere.scene();
    const std::vector<Vec3> points = sphere.interior_points();
    expect_watertight(*build(scene), sphere, std::span(points).last(origins), what);
  };
  expect(ClosedSphere(), 4, "unit");
  expect(ClosedSphere(1e-3f), 1, "tiny");
  expect(ClosedSphere(1e3f), 1, "large");
  expect(ClosedSphere(1, {1e3f, 1e3f, 1e3f}), 1, "moved");
  expect(ClosedSphere(1, {}, true), 1, "turned");
}

}  // namespace raymeter
