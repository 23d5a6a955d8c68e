#include "accel/two_level_grid.h"

#include <algorithm>
#include <utility>

#include "accel/cell_query.h"
#include "accel/grid_walk.h"
#include "accel/leaf_grid.h"
#include "accel/per_ray_structure.h"
#include "accel/two_level_cells.h"

namespace raymeter {
namespace {

class TwoLevelGrid final : public PerRayStructure<TwoLevelGrid> {
 public:
  TwoLevelGrid(const BuildInput& input, const TwoLevelOptions& options)
      : PerRayStructure(input.scene),
        meter_(input.memory_limit),
        space_(walk_space_of(input.scene)),
        cells_(input.scene, space_, ResolutionLimits::within(input.memory_limit, 4 * space_.margin),
               registration_limit(input.scene.primitive_count()), options, meter_),
        stats_(cells_.stats()) {
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"top_cells", cells_.top_bytes()},
                            {"top_references", cells_.top_lists().reference_bytes()},
                            {"sub-grids", cells_.subgrid_bytes()},
                            {"leaf_cells", cells_.leaf_lists().offset_bytes()},
                            {"leaf_references", cells_.leaf_lists().reference_bytes()}};
  }

  StructureStats stats() const override { return stats_; }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return answer<ClosestQuery<NoMailbox, Probe>>(ray, probe);
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return answer<AnyQuery<NoMailbox, Probe>>(ray, probe);
  }

 private:
  template <class Query, class Probe>
  typename Query::Answer answer(const Ray& ray, Probe& probe) const {
    return answer_by_walk<Query>(
        scene(), space_, ray, probe,
        [this, &probe](const WalkRay& walk, const WalkInterval& interval, Query& query) {
          walk_cells(cells_.grid(), walk, interval, [&](std::uint64_t top, double enter, double leave) {
            const std::uint32_t subgrid = cells_.subgrid_of(top);
            if (subgrid == TwoLevelCells::no_subgrid) {
              query.visit(cells_.top_lists()[top]);
              return query.last();
            }
            // Walk the cell's own grid, from where the ray enters the cell to where it leaves it.
            probe.inner_step();
            probe.enter_subgrid();
            const SubGrid& sub = cells_.subgrids()[subgrid];
            walk_cells(sub.grid, walk, {enter, leave}, [&](std::uint64_t cell, double, double) {
              query.visit(cells_.leaf_lists()[sub.first_cell + cell]);
              return std::min(leave, query.last());
            });
            return query.last();
          });
        });
  }

  MemoryMeter meter_;
  WalkSpace space_;
  TwoLevelCells cells_;
  StructureStats stats_;
};

}  // namespace

// The defaults are near the best that was measured on teapot12 and gears4 (SPD) and a soup of 60,000
// triangles: a coarse top level, which costs few steps where nothing is, and sub-grids of the density of a
// good flat grid.
StructureKind two_level_grid_kind() {
  auto parameters = resolution_parameters("density 0.1");
  parameters.push_back({"threshold", ParameterType::integer, "8",
                        "a cell with more primitives than this gets a grid of its own", 0, 1e9});
  parameters.push_back({"leaf-density", ParameterType::number, "3",
                        "cells of that grid for each primitive of the cell", 1e-3, 1e3});
  parameters.push_back(fit_parameter());
  for (Parameter& parameter : leaf_parameters()) parameters.push_back(std::move(parameter));
  return {"two-level-grid",
          "a uniform grid whose crowded cells hold a grid of their own",
          "Jevans & Wyvill 1989; walk and lists as the grid's",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            TwoLevelOptions options;
            options.top = resolution_rule(arguments, {ResolutionRule::Kind::density, 0.1});
            options.leaf = {ResolutionRule::Kind::density, arguments.number("leaf-density")};
            options.threshold = static_cast<std::uint64_t>(arguments.integer("threshold"));
            options.fit = fit_of(arguments);
            if (auto simd = build_leaf_grid(arguments, input, options)) return simd;
            return std::make_unique<TwoLevelGrid>(input, options);
          }};
}

}  // namespace raymeter
