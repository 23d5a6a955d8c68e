#include "scenes/generators/paper/mesh_builder.h"

#include <algorithm>

#include "scenes/base/portable_math.h"

namespace raymeter {
namespace {

constexpr std::array<std::uint32_t, 3> flat{SceneData::no_normal, SceneData::no_normal, SceneData::no_normal};

const Vec3d& point_of(const Ring& ring, std::size_t side) {
  return ring.points[side % ring.points.size()];
}

/// The normal, with the length of the area, of the part between two rings and two neighbouring sides.
Vec3d facet_normal(const Ring& lower, const Ring& upper, std::size_t side) {
  return cross(point_of(lower, side + 1) - point_of(upper, side),
               point_of(upper, side + 1) - point_of(lower, side));
}

}  // namespace

std::vector<Ring> turned_rings(const Vec3d& foot, std::span<const OutlinePoint> outline,
                               std::uint32_t sides) {
  std::vector<Ring> rings;
  for (const OutlinePoint& point : outline) {
    Ring ring{{}, point.sharp};
    for (std::uint32_t side = 0; side < (point.radius > 0 ? sides : 1); ++side) {
      const auto [sine, cosine] = sine_cosine_of_turns(double(side) / sides);
      ring.points.push_back(foot + Vec3d{point.radius * cosine, point.height, point.radius * -sine});
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

std::uint32_t MeshBuilder::add_material(const Material& material) {
  data_.materials.push_back(material);
  return material_ = static_cast<std::uint32_t>(data_.materials.size() - 1);
}

std::uint32_t MeshBuilder::add_vertex(const Vec3d& point) {
  data_.vertices.push_back(to_float(point));
  return static_cast<std::uint32_t>(data_.vertices.size() - 1);
}

std::uint32_t MeshBuilder::add_normal(const Vec3d& direction) {
  data_.normals.push_back(to_float(normalized(direction)));
  return static_cast<std::uint32_t>(data_.normals.size() - 1);
}

void MeshBuilder::add_triangle(const std::array<std::uint32_t, 3>& corners,
                               const std::array<std::uint32_t, 3>& normals) {
  data_.triangles.push_back(corners);
  data_.triangle_normals.push_back(normals);
  data_.triangle_materials.push_back(material_);
}

void MeshBuilder::add_quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const std::uint32_t first = add_vertex(a);
  for (const Vec3d& corner : {b, c, d}) add_vertex(corner);
  add_triangle({first, first + 1, first + 2}, flat);
  add_triangle({first, first + 2, first + 3}, flat);
}

void MeshBuilder::add_smooth_quad(const std::array<Vec3d, 4>& corners, const std::array<Vec3d, 4>& normals) {
  const auto v = static_cast<std::uint32_t>(data_.vertices.size());
  const auto n = static_cast<std::uint32_t>(data_.normals.size());
  for (const Vec3d& corner : corners) add_vertex(corner);
  for (const Vec3d& normal : normals) add_normal(normal);
  add_triangle({v, v + 1, v + 2}, {n, n + 1, n + 2});
  add_triangle({v, v + 2, v + 3}, {n, n + 2, n + 3});
}

void MeshBuilder::add_box(const Vec3d& low, const Vec3d& high) {
  const auto corner = [&](int x, int y, int z) {
    return Vec3d{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
  };
  add_quad(corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1));
  add_quad(corner(1, 0, 0), corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0));
  add_quad(corner(1, 0, 1), corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1));
  add_quad(corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0));
  add_quad(corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0), corner(0, 1, 0));
  add_quad(corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1));
}

void MeshBuilder::add_loft(std::span<const Ring> rings) {
  std::size_t sides = 1;
  for (const Ring& ring : rings) sides = std::max(sides, ring.points.size());

  std::vector<std::uint32_t> vertices;  // of each ring the first
  for (const Ring& ring : rings) {
    vertices.push_back(static_cast<std::uint32_t>(data_.vertices.size()));
    for (const Vec3d& point : ring.points) add_vertex(point);
  }
  // The shading normal at a corner of the part between rings `level` and `level + 1`: of the facets about it,
  // but not of those beyond a sharp ring. A single point has one for each side.
  const auto corner_normal = [&](std::size_t ring, std::size_t side, std::size_t level) {
    Vec3d sum;
    for (std::size_t other = ring > 0 ? ring - 1 : 0; other <= ring && other + 1 < rings.size(); ++other) {
      if (other != level && rings[ring].sharp) continue;
      for (const std::size_t facet : {side + sides - 1, side})
        sum = sum + facet_normal(rings[other], rings[other + 1], facet % sides);
    }
    return sum;
  };
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::size_t level = 0; level + 1 < rings.size(); ++level) {
    const auto normals = static_cast<std::uint32_t>(data_.normals.size());  // lower ring's, then upper ring's
    for (const std::size_t ring : {level, level + 1})
      for (std::size_t side = 0; side < sides; ++side) add_normal(corner_normal(ring, side, level));
    const bool lower_is_point = rings[level].points.size() == 1,
               upper_is_point = rings[level + 1].points.size() == 1;
    for (std::uint32_t side = 0; side < count; ++side) {
      const std::uint32_t next = (side + 1) % count;
      const auto lower = [&](std::uint32_t s) { return vertices[level] + (lower_is_point ? 0 : s); };
      const auto upper = [&](std::uint32_t s) { return vertices[level + 1] + (upper_is_point ? 0 : s); };
      if (!lower_is_point)
        add_triangle({lower(side), lower(next), upper(next)},
                     {normals + side, normals + next, normals + count + next});
      if (!upper_is_point)
        add_triangle({lower(side), upper(next), upper(side)},
                     {normals + side, normals + count + next, normals + count + side});
    }
  }
}

void MeshBuilder::add_lathe(const Vec3d& foot, std::span<const OutlinePoint> outline, std::uint32_t sides) {
  add_loft(turned_rings(foot, outline, sides));
}

}  // namespace raymeter
