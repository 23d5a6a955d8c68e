#include "accel/uniform_grid.h"

#include <array>
#include <limits>

#include "accel/cell_lists.h"
#include "accel/cell_overlap.h"
#include "accel/grid_resolution.h"
#include "accel/grid_walk.h"
#include "accel/mailbox.h"
#include "accel/per_ray_structure.h"
#include "accel/primitive_test.h"

namespace raymeter {
namespace {

struct Options {
  ResolutionRule rule;
  Fit fit = Fit::box;
  bool mailbox = false;
};

class UniformGrid final : public PerRayStructure<UniformGrid> {
 public:
  UniformGrid(const BuildInput& input, const Options& options)
      : PerRayStructure(input.scene), options_(options), meter_(input.memory_limit), lists_(meter_) {
    const Scene& scene = input.scene;
    space_ = WalkSpace(scene.bounds().empty() ? Bounds{{0, 0, 0}, {0, 0, 0}} : scene.bounds());
    const auto limits = ResolutionLimits::within(input.memory_limit, 4 * space_.margin);
    const auto chosen = choose_resolution(options.rule, shape_sizes(scene), limits);
    grid_ = CellGrid(space_.low, space_.high, chosen.n);
    lists_.build(cell_count(chosen.n), [&](auto add) {
      for (std::uint32_t p = 0; p < scene.primitive_count(); ++p)
        for_each_cell_of(scene, p, grid_, space_.margin, options.fit, [&](std::uint64_t c) { add(c, p); });
    });

    stats_.resolution = chosen.n;
    stats_.cells = lists_.cells();
    stats_.empty_cells = lists_.empty_cells();
    stats_.references = lists_.references();
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"cells", lists_.offset_bytes()}, {"references", lists_.reference_bytes()}};
    stats_.note = chosen.note;
  }

  StructureStats stats() const override { return stats_; }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return options_.mailbox ? closest_hit<Mailbox>(ray, probe) : closest_hit<NoMailbox>(ray, probe);
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return options_.mailbox ? any_hit<Mailbox>(ray, probe) : any_hit<NoMailbox>(ray, probe);
  }

 private:
  template <class Box, class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit best;
    if (!is_traceable(ray)) return best;
    const WalkRay walk(ray);
    if (too_far(walk, space_)) return closest_of_all(scene(), ray, probe);
    const WalkInterval interval = clip(walk, ray, space_.low, space_.high);
    if (interval.empty()) return best;

    const FilterRay filter(ray);
    Box mailbox;
    double last = interval.leave;
    walk_cells(grid_, walk, interval, [&](std::uint64_t cell, double, double) {
      const auto primitives = lists_[cell];
      probe.cell_step(primitives.empty());
      for (const std::uint32_t p : primitives)
        if (mailbox.is_new(p)) test_closest(scene(), p, filter, best, probe);
      // A hit may lie beyond this cell: it stands, and the walk goes on until nothing can beat it.
      if (!primitives.empty() && best.found()) last = std::min(last, latest(best.t));
      return last;
    });
    return best;
  }

  template <class Box, class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    if (!is_traceable(ray)) return false;
    const WalkRay walk(ray);
    if (too_far(walk, space_)) return any_of_all(scene(), ray, probe);
    const WalkInterval interval = clip(walk, ray, space_.low, space_.high);
    if (interval.empty()) return false;

    const FilterRay filter(ray);
    Box mailbox;
    bool hit = false;
    walk_cells(grid_, walk, interval, [&](std::uint64_t cell, double, double) {
      const auto primitives = lists_[cell];
      probe.cell_step(primitives.empty());
      for (const std::uint32_t p : primitives)
        if (mailbox.is_new(p) && test_any(scene(), p, filter, probe)) {
          hit = true;
          return -std::numeric_limits<double>::infinity();
        }
      return interval.leave;
    });
    return hit;
  }

  Options options_;
  MemoryMeter meter_;
  CellLists lists_;
  WalkSpace space_;
  CellGrid grid_;
  StructureStats stats_;
};

}  // namespace

StructureKind grid_kind() {
  return {"grid",
          "the paper's heuristic grid: cells as large as the mean bounding box",
          "Sakai, Watanabe, Miyoshi, Fukuda, early 1990s; walk: Fujimoto et al. 1986, Amanatides & Woo 1987; "
          "lists: Lagae & Dutre 2008",
          Answers::exact,
          {{"amount", ParameterType::number, "1",
            "relative subdivision amount: n_a = round(amount L_a / m_a)", 1e-3, 1e3}},
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            Options options;
            options.rule = {ResolutionRule::Kind::amount, arguments.number("amount")};
            return std::make_unique<UniformGrid>(input, options);
          }};
}

StructureKind tunable_grid_kind() {
  auto parameters = resolution_parameters("density 4");
  parameters.push_back({"fit",
                        ParameterType::choice,
                        "exact",
                        "register primitives where their bounding box (box) or they themselves (exact) lie",
                        0,
                        0,
                        {"box", "exact"}});
  parameters.push_back(
      {"mailbox", ParameterType::flag, "off",
       "remember the last primitives that a ray tested (8 slots), and don't test them again"});
  return {"tunable-grid",
          "a uniform grid with every knob free",
          "Fujimoto et al. 1986, Amanatides & Woo 1987, Lagae & Dutre 2008; exact fit: Akenine-Moeller 2001; "
          "mailbox: Shevtsov et al. 2007",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            Options options;
            options.rule = resolution_rule(arguments, {ResolutionRule::Kind::density, 4});
            options.fit = arguments.text("fit") == "box" ? Fit::box : Fit::exact;
            options.mailbox = arguments.flag("mailbox");
            return std::make_unique<UniformGrid>(input, options);
          }};
}

}  // namespace raymeter
