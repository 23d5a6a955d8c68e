#include "accel/cell_overlap.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "accel/note.h"
#include "accel/parallel.h"
#include "accel/sparse_lists.h"

namespace raymeter {

Parameter fit_parameter() {
  return {.name = "fit",
          .type = ParameterType::choice,
          .default_value = "exact",
          .meaning = "register primitives where their bounding box (box) or they themselves (exact) lie",
          .choices = {"box", "exact"}};
}

Fit fit_of(const Arguments& arguments) {
  return arguments.text("fit") == "box" ? Fit::box : Fit::exact;
}

TriangleOverlap::TriangleOverlap(const Triangle& triangle, const Vec3d& half, double slack)
    : corner_(to_double(triangle.a)) {
  // All relative to the first vertex, so that a triangle far from 0 loses nothing.
  const Vec3d b = to_double(triangle.b) - corner_, c = to_double(triangle.c) - corner_;
  const auto set = [&](std::size_t i, const Vec3d& axis) {
    const double to_b = dot(axis, b), to_c = dot(axis, c);
    const double reach = std::abs(axis.x) * (half.x + slack) + std::abs(axis.y) * (half.y + slack) +
                         std::abs(axis.z) * (half.z + slack);
    slabs_[i] = {axis, std::min({0.0, to_b, to_c}) - reach, std::max({0.0, to_b, to_c}) + reach};
  };
  // The plane of the triangle first: it separates most often.
  set(0, cross(b, c));
  std::size_t i = 1;
  for (const Vec3d& e : {b, c, c - b}) {
    set(i++, {0, -e.z, e.y});
    set(i++, {e.z, 0, -e.x});
    set(i++, {-e.y, e.x, 0});
  }
}

bool SphereOverlap::meets(const Vec3d& centre) const {
  double nearest = 0, farthest = 0;  // squared distances from the sphere's centre to the grown box
  for (int axis = 0; axis < 3; ++axis) {
    const double distance = std::abs(centre[axis] - centre_[axis]), reach = half_[axis] + slack_;
    const double gap = std::max(0.0, distance - reach);
    nearest += gap * gap;
    farthest += (distance + reach) * (distance + reach);
  }
  return nearest <= radius_ * radius_ && radius_ * radius_ <= farthest;
}

namespace {

/// The grid of the chosen resolution, made coarser until is_registrable(grid).
template <class IsRegistrable>
CellGrid coarsened(const WalkSpace& space, std::uint64_t limit, ChosenResolution& chosen,
                   const IsRegistrable& is_registrable) {
  const Resolution asked = chosen.n;
  CellGrid grid(space.low, space.high, chosen.n);
  while (!is_registrable(grid)) {
    for (auto& n : chosen.n) n = std::max(1u, n * 4 / 5);
    grid = CellGrid(space.low, space.high, chosen.n);
  }
  if (chosen.n != asked) {
    add_note(chosen.note, fmt::format("clamped from {} to {} (limit {} cells in all primitives' boxes)",
                                      fmt::join(asked, "x"), fmt::join(chosen.n, "x"), limit));
    chosen.clamped = true;
  }
  return grid;
}

}  // namespace

CellGrid registrable_grid(const Scene& scene, const WalkSpace& space, std::uint64_t limit,
                          ChosenResolution& chosen) {
  return coarsened(space, limit, chosen, [&](const CellGrid& grid) {
    const auto work = sum_of_ranges<std::uint64_t>(
        scene.primitive_count(), 4096, [&](std::uint64_t begin, std::uint64_t end) {
          std::uint64_t part = 0;
          for (std::uint64_t p = begin; p < end; ++p)
            part += cells_of_box(grid, scene.bounds_of(static_cast<std::uint32_t>(p)), space.margin).cells();
          return part;
        });
    return work <= limit;
  });
}

CellGrid register_primitives(const Scene& scene, const WalkSpace& space, std::uint64_t limit, Fit fit,
                             ChosenResolution& chosen, SparseLists& lists) {
  return coarsened(space, limit, chosen, [&](const CellGrid& grid) {
    std::atomic<std::uint64_t> work = 0;
    return lists.build(cell_count(grid.n), scene.primitive_count(),
                       [&](std::uint32_t begin, std::uint32_t end, const auto& add) {
                         std::uint64_t part = 0;
                         for (std::uint32_t p = begin; p < end; ++p) {
                           const CellRange range = cells_of_box(grid, scene.bounds_of(p), space.margin);
                           part += range.cells();
                           if (part > limit) return false;
                           for_each_run_of(
                               scene, p, grid, space.margin, range, fit,
                               [&](std::uint64_t first, std::uint64_t count) { add(p, first, count); });
                         }
                         return (work += part) <= limit;
                       });
  });
}

}  // namespace raymeter
