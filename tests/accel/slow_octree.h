#pragma once
// What an octree must cost a ray, found without walking: every leaf's box is met with the ray in extended
// precision, the leaves are sorted by entry, and the rule of termination is applied to them.
#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "accel/structure.h"
#include "accel/walk_space.h"
#include "scenes/geometry/decide.h"
#include "scenes/scene.h"

namespace raymeter {

class SlowOctree {
 public:
  using Real = long double;

  SlowOctree(const Scene& scene, std::uint32_t leaf, int depth)
      : scene_(scene), space_(scene.bounds()), leaf_(leaf), depth_(depth) {
    const Vec3d extent = space_.extent();
    Node root{-1, 0, {}, std::max({extent.x, extent.y, extent.z}), {}, true};
    for (int axis = 0; axis < 3; ++axis) root.low[axis] = space_.low[axis];
    for (std::uint32_t primitive = 0; primitive < scene.primitive_count(); ++primitive)
      root.primitives.push_back(primitive);
    grow(root);
  }

  struct Totals {
    std::uint64_t leaves = 0, empty = 0, inner = 0, references = 0;
    std::uint32_t depth = 0;
  };
  Totals totals() const {
    Totals totals;
    for (const Node& node : nodes_) {
      totals.depth = std::max(totals.depth, static_cast<std::uint32_t>(node.level));
      if (!node.is_leaf) {
        ++totals.inner;
        continue;
      }
      ++totals.leaves;
      totals.empty += node.primitives.empty();
      totals.references += node.primitives.size();
    }
    return totals;
  }

  struct Costs {
    RayCounters glassner, top_down;
    bool close_call = false;  ///< two events so near to each other that rounding may swap them
  };
  Costs costs(const Ray& ray, QueryKind query) const {
    struct Visit {
      Real enter;
      int node;
    };
    Costs costs;
    std::vector<Visit> visits;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!nodes_[i].is_leaf) continue;
      const auto [enter, leave] = interval(ray, nodes_[i]);
      // A cell that is only just touched, or only just missed.
      if (std::abs(leave - enter) < 1e-12L * (std::abs(enter) + 1)) costs.close_call = true;
      if (enter < leave) visits.push_back({enter, static_cast<int>(i)});
    }
    std::ranges::sort(visits, {}, &Visit::enter);

    RayCounters counters;
    std::uint32_t levels = 0;
    std::set<int> inner, tested;
    Hit best;
    for (const Visit& visit : visits) {
      if (visit.enter - std::abs(visit.enter) * 0x1p-22L > best.t) break;
      const Node& node = nodes_[static_cast<std::size_t>(visit.node)];
      ++counters.cell_steps;
      counters.empty_cell_steps += node.primitives.empty();
      levels += static_cast<std::uint32_t>(node.level);
      for (int up = node.parent; up >= 0; up = nodes_[static_cast<std::size_t>(up)].parent) inner.insert(up);
      for (const std::uint32_t primitive : node.primitives) {
        ++counters.tests;
        tested.insert(static_cast<int>(primitive));
        const float t = scene_.visit(primitive, [&](const auto& shape) { return decide(ray, shape); });
        if (t != no_hit) best = std::min(best, Hit{t, primitive});
        if (best.found() && query == QueryKind::any) break;
      }
      if (best.found() && query == QueryKind::any) break;
    }
    counters.distinct_tests = static_cast<std::uint32_t>(tested.size());
    costs.glassner = costs.top_down = counters;
    costs.glassner.steps = counters.cell_steps + levels;
    costs.glassner.point_locations = counters.cell_steps;
    costs.top_down.steps = counters.cell_steps + static_cast<std::uint32_t>(inner.size());
    return costs;
  }

 private:
  struct Node {
    int parent, level;
    std::array<Real, 3> low;
    Real size;
    std::vector<std::uint32_t> primitives;
    bool is_leaf;
  };

  void grow(const Node& node) {
    const int index = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    if (node.primitives.size() <= leaf_ || node.level == depth_) return;
    std::array<Node, 8> children;
    bool separates = false;
    for (unsigned k = 0; k < 8; ++k) {
      children[k] = {index, node.level + 1, node.low, node.size / 2, {}, true};
      for (unsigned axis = 0; axis < 3; ++axis)
        if (k >> axis & 1u) children[k].low[axis] += node.size / 2;
      for (const std::uint32_t primitive : node.primitives)
        if (meets(primitive, children[k])) children[k].primitives.push_back(primitive);
      separates |= children[k].primitives.size() < node.primitives.size();
    }
    if (!separates) return;
    nodes_[static_cast<std::size_t>(index)].is_leaf = false;
    for (const Node& child : children) grow(child);
  }

  using Point = std::array<Real, 3>;

  /// Whether a triangle or the surface of a sphere, or the bounding box of another quadric, meets the cell
  /// grown by the margin.
  bool meets(std::uint32_t primitive, const Node& node) const {
    Point low = node.low, high = node.low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] -= space_.margin;
      high[axis] += node.size + space_.margin;
    }
    if (scene_.is_triangle(primitive)) return !clipped(scene_.triangle(primitive), low, high).empty();
    const Quadric& quadric = scene_.quadric(primitive);
    Real nearest = 0, farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Bounds box = scene_.bounds_of(primitive);
      const int a = static_cast<int>(axis);
      if (box.low[a] > high[axis] || box.high[a] < low[axis]) return false;
      const Real centre = quadric.base[a], nearer = std::clamp(centre, low[axis], high[axis]) - centre;
      const Real farther = std::max(std::abs(low[axis] - centre), std::abs(high[axis] - centre));
      nearest += nearer * nearer;
      farthest += farther * farther;
    }
    const Real square = Real(quadric.base_radius) * quadric.base_radius;
    return quadric.kind != QuadricKind::sphere || (nearest <= square && square <= farthest);
  }

  /// What is left of a triangle inside a box, as a polygon: Sutherland and Hodgman, 1974.
  static std::vector<Point> clipped(const Triangle& triangle, const Point& low, const Point& high) {
    std::vector<Point> polygon;
    for (const Vec3& v : {triangle.a, triangle.b, triangle.c}) polygon.push_back({v.x, v.y, v.z});
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const bool lower : {true, false}) {
        const auto inside = [&](const Point& p) {
          return lower ? p[axis] - low[axis] : high[axis] - p[axis];
        };
        std::vector<Point> rest;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
          const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
          const Real at_a = inside(a), at_b = inside(b);
          if (at_a >= 0) rest.push_back(a);
          if ((at_a < 0) == (at_b < 0)) continue;
          Point cut;
          for (std::size_t k = 0; k < 3; ++k) cut[k] = a[k] + (b[k] - a[k]) * (at_a / (at_a - at_b));
          rest.push_back(cut);
        }
        polygon = std::move(rest);
      }
    return polygon;
  }

  /// The part of the ray inside a node and inside the box of the scene.
  std::pair<Real, Real> interval(const Ray& ray, const Node& node) const {
    Real enter = ray.tnear, leave = ray.tfar;
    for (int axis = 0; axis < 3; ++axis) {
      const Real low = std::max<Real>(node.low[static_cast<std::size_t>(axis)], space_.low[axis]);
      const Real high =
          std::min<Real>(node.low[static_cast<std::size_t>(axis)] + node.size, space_.high[axis]);
      if (low >= high) return {1, 0};
      const Real origin = ray.origin[axis], direction = ray.direction[axis];
      if (direction == 0) {
        if (origin < low || origin >= high) return {1, 0};
        continue;
      }
      const Real a = (low - origin) / direction, b = (high - origin) / direction;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return {enter, leave};
  }

  const Scene& scene_;
  WalkSpace space_;
  std::size_t leaf_;
  int depth_;
  std::vector<Node> nodes_;
};

}  // namespace raymeter
