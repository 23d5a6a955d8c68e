#pragma once
// Which cells of a grid a primitive must be registered in. All tests here may say yes too often, never no
// wrongly: a cell counts as met when the primitive meets its box grown by the margin of walk_space.h.
#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "accel/cell_grid.h"
#include "accel/grid_resolution.h"
#include "accel/walk_space.h"
#include "scenes/base/spec.h"
#include "scenes/geometry/primitives.h"
#include "scenes/geometry/quadric_field.h"
#include "scenes/scene.h"

namespace raymeter {

class SparseLists;

/// The space to subdivide; of an empty scene, a point.
inline WalkSpace walk_space_of(const Scene& scene) {
  return WalkSpace(scene.bounds().empty() ? Bounds{{0, 0, 0}, {0, 0, 0}} : scene.bounds());
}

/// How closely primitives are registered.
enum class Fit : std::uint8_t {
  box,    ///< in every cell that their bounding box meets
  exact,  ///< only in cells that they meet themselves; cylinders and cones as `box`
};
/// The parameter `fit` of grids, and the value given for it.
Parameter fit_parameter();
Fit fit_of(const Arguments& arguments);

/// The surface of a triangle against boxes of one size: the separating axes of Akenine-Moeller, "Fast 3D
/// Triangle-Box Overlap Testing", 2001, except the three of the box itself, with the triangle's part of the
/// work done once. Any vector may be tried as a separating axis, so rounding in the axes does no harm; that
/// of the projections is far below `slack`.
class TriangleOverlap {
 public:
  /// `half`: half the size of the boxes. `slack` > 0: boxes nearer than that count as met.
  TriangleOverlap(const Triangle& triangle, const Vec3d& half, double slack);
  /// Assumes that the triangle's bounding box meets the box about `centre`.
  bool meets(const Vec3d& centre) const {
    const Vec3d p = centre - corner_;
    for (const Slab& slab : slabs_) {
      const double along = dot(slab.axis, p);
      if (along < slab.low || along > slab.high) return false;
    }
    return true;
  }

 private:
  struct Slab {
    Vec3d axis;
    double low, high;  // where the box's centre must lie along the axis, from corner_
  };
  Vec3d corner_;
  std::array<Slab, 10> slabs_;
};

/// The surface of a sphere against boxes of one size: not those wholly outside, nor those wholly inside.
class SphereOverlap {
 public:
  SphereOverlap(const Quadric& sphere, const Vec3d& half, double slack)
      : centre_(to_double(sphere.base)), radius_(sphere.base_radius), half_(half), slack_(slack) {}
  bool meets(const Vec3d& centre) const;

 private:
  Vec3d centre_;
  double radius_;
  Vec3d half_;
  double slack_;
};

/// The surface of a general quadric against boxes of one size: those in which its polynomial may be zero.
class GeneralQuadricOverlap {
 public:
  GeneralQuadricOverlap(const GeneralQuadric& quadric, const Vec3d& half, double slack)
      : field_(quadric), reach_(half + Vec3d{slack, slack, slack}) {}
  bool meets(const Vec3d& centre) const {
    const Vec3d middle = centre - field_.centre();
    return !field_.certainly_misses({middle - reach_, middle + reach_});
  }

 private:
  QuadricField field_;
  Vec3d reach_;
};

/// Of a primitive that is only known to lie in its bounding box.
struct BoxOverlap {
  bool meets(const Vec3d&) const { return true; }
};

/// Returns use(overlap), where `overlap` answers whether the primitive meets boxes of one size that its
/// bounding box meets.
template <class Use>
decltype(auto) with_overlap(const Scene& scene, std::uint32_t primitive, const Vec3d& half, double slack,
                            const Use& use) {
  return scene.visit(primitive, [&]<class Shape>(const Shape& shape) {
    if constexpr (std::is_same_v<Shape, Triangle>) {
      return use(TriangleOverlap(shape, half, slack));
    } else if constexpr (std::is_same_v<Shape, GeneralQuadric>) {
      return use(GeneralQuadricOverlap(shape, half, slack));
    } else {
      return shape.kind == QuadricKind::sphere ? use(SphereOverlap(shape, half, slack)) : use(BoxOverlap());
    }
  });
}

/// Layers first..last of a grid on each axis.
struct CellRange {
  std::array<std::uint32_t, 3> first, last;
  std::uint64_t cells() const {
    return (std::uint64_t{last[0]} - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
  }
};

/// The cells whose boxes, grown by `margin`, meet `box`.
inline CellRange cells_of_box(const CellGrid& grid, const Bounds& box, double margin) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.first[axis] = grid.layer(axis, box.low[axis] - margin);
    range.last[axis] = grid.layer(axis, box.high[axis] + margin);
  }
  return range;
}

/// Registering looks at every cell of every primitive's box: at so many, at most.
inline std::uint64_t registration_limit(std::uint64_t primitives) {
  return std::max(std::uint64_t{1} << 26, 64 * primitives);
}

/// The grid of the chosen resolution over `space`; made coarser, with a note in `chosen`, where registering
/// the scene's primitives would exceed the limit (many primitives, each as large as the scene).
CellGrid registrable_grid(const Scene& scene, const WalkSpace& space, std::uint64_t limit,
                          ChosenResolution& chosen);
/// The same grid, and in `lists` the primitives that are registered in each of its cells.
CellGrid register_primitives(const Scene& scene, const WalkSpace& space, std::uint64_t limit, Fit fit,
                             ChosenResolution& chosen, SparseLists& lists);

/// Calls visit(first, count) for the runs of cells side by side, within the range, whose centres satisfy
/// `meets`.
template <class Meets, class Visit>
void for_each_run(const CellGrid& grid, const CellRange& range, const Meets& meets, const Visit& visit) {
  for (std::uint32_t k = range.first[2]; k <= range.last[2]; ++k)
    for (std::uint32_t j = range.first[1]; j <= range.last[1]; ++j) {
      std::uint32_t begin = range.first[0];
      const auto end_run = [&](std::uint32_t i) {
        if (i > begin) visit(grid.cell(begin, j, k), i - begin);
        begin = i + 1;
      };
      for (std::uint32_t i = begin; i <= range.last[0]; ++i)
        if (!meets(Vec3d{grid.plane(0, i + 0.5), grid.plane(1, j + 0.5), grid.plane(2, k + 0.5)})) end_run(i);
      end_run(range.last[0] + 1);
    }
}

/// Calls visit(first, count) for runs of cells side by side, which together are those in which `primitive` is
/// to be registered, each once. `range` is that of its box. Triangles without area, which are never hit, are
/// registered like any other: counts of references are those of the rule.
template <class Visit>
void for_each_run_of(const Scene& scene, std::uint32_t primitive, const CellGrid& grid, double margin,
                     const CellRange& range, Fit fit, const Visit& visit) {
  if (fit == Fit::box || range.first == range.last) {
    const std::uint32_t nx = range.last[0] - range.first[0] + 1, ny = range.last[1] - range.first[1] + 1,
                        nz = range.last[2] - range.first[2] + 1;
    const std::uint64_t row = grid.n[0], layer = row * grid.n[1];
    std::uint64_t begin = grid.cell(range.first[0], range.first[1], range.first[2]);
    for (std::uint32_t k = 0; k < nz; ++k, begin += layer)
      for (std::uint64_t j = 0; j < ny; ++j) visit(begin + j * row, nx);
    return;
  }
  // Twice the margin: once for the walk, once for the rounding of the overlap tests.
  const Vec3d half = 0.5 * grid.size;
  const double slack = 2 * margin;
  with_overlap(scene, primitive, half, slack, [&](const auto& overlap) {
    for_each_run(grid, range, [&](const Vec3d& centre) { return overlap.meets(centre); }, visit);
  });
}

/// Calls visit(cell) once for each of those cells.
template <class Visit>
void for_each_cell_of(const Scene& scene, std::uint32_t primitive, const CellGrid& grid, double margin,
                      Fit fit, const Visit& visit) {
  const CellRange range = cells_of_box(grid, scene.bounds_of(primitive), margin);
  for_each_run_of(scene, primitive, grid, margin, range, fit, [&](std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t cell = first; cell < first + count; ++cell) visit(cell);
  });
}

}  // namespace raymeter
