#include "accel/uniform_grid.h"

#include "accel/cell_overlap.h"
#include "accel/cell_query.h"
#include "accel/grid_resolution.h"
#include "accel/grid_walk.h"
#include "accel/leaf_grid.h"
#include "accel/per_ray_structure.h"
#include "accel/sparse_lists.h"
#include "scenes/base/error.h"

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
    space_ = walk_space_of(scene);
    const auto limits = ResolutionLimits::within(input.memory_limit, 4 * space_.margin);
    auto chosen = choose_resolution(options.rule, shape_sizes(scene), limits);
    grid_ = register_primitives(scene, space_, registration_limit(scene.primitive_count()), options.fit,
                                chosen, lists_);

    stats_.resolution = chosen.n;
    stats_.cells = lists_.cells();
    stats_.empty_cells = lists_.empty_cells();
    stats_.references = lists_.references();
    stats_.bytes = meter_.bytes();
    stats_.peak_bytes = meter_.peak();
    stats_.bytes_by_part = {{"cells", lists_.cell_bytes()}, {"references", lists_.reference_bytes()}};
    stats_.note = chosen.note;
  }

  StructureStats stats() const override { return stats_; }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return options_.mailbox ? answer<ClosestQuery<Mailbox, Probe>>(ray, probe)
                            : answer<ClosestQuery<NoMailbox, Probe>>(ray, probe);
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return options_.mailbox ? answer<AnyQuery<Mailbox, Probe>>(ray, probe)
                            : answer<AnyQuery<NoMailbox, Probe>>(ray, probe);
  }

 private:
  template <class Query, class Probe>
  typename Query::Answer answer(const Ray& ray, Probe& probe) const {
    return answer_by_walk<Query>(scene(), space_, ray, probe,
                                 [this](const WalkRay& walk, const WalkInterval& interval, Query& query) {
                                   walk_cells(grid_, walk, interval, [&](std::uint64_t cell, double, double) {
                                     query.visit(lists_[cell]);
                                     return query.last();
                                   });
                                 });
  }

  Options options_;
  MemoryMeter meter_;
  SparseLists lists_;
  WalkSpace space_;
  CellGrid grid_;
  StructureStats stats_;
};

}  // namespace

StructureKind grid_kind() {
  auto parameters = leaf_parameters();
  parameters.insert(parameters.begin(),
                    {"amount", ParameterType::number, "1",
                     "relative subdivision amount: n_a = round(amount L_a / m_a)", 1e-3, 1e3});
  return {"grid",
          "the paper's heuristic grid: cells as large as the mean bounding box",
          "Sakai, Watanabe, Miyoshi, Fukuda, early 1990s; walk: Fujimoto et al. 1986, Amanatides & Woo 1987; "
          "lists: Lagae & Dutre 2008",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            Options options;
            options.rule = {ResolutionRule::Kind::amount, arguments.number("amount")};
            if (auto simd = build_leaf_grid(arguments, input, options.rule, options.fit)) return simd;
            return std::make_unique<UniformGrid>(input, options);
          }};
}

StructureKind tunable_grid_kind() {
  auto parameters = resolution_parameters("density 4");
  parameters.push_back(fit_parameter());
  parameters.push_back(
      {"mailbox", ParameterType::flag, "off",
       "remember the last primitives that a ray tested (8 slots), and don't test them again"});
  for (Parameter& parameter : leaf_parameters()) parameters.push_back(std::move(parameter));
  return {"tunable-grid",
          "a uniform grid with every knob free",
          "Fujimoto et al. 1986, Amanatides & Woo 1987, Lagae & Dutre 2008; exact fit: Akenine-Moeller 2001; "
          "mailbox: Shevtsov et al. 2007",
          Answers::exact,
          std::move(parameters),
          [](const Arguments& arguments, const BuildInput& input) -> std::unique_ptr<Structure> {
            Options options;
            options.rule = resolution_rule(arguments, {ResolutionRule::Kind::density, 4});
            options.fit = fit_of(arguments);
            options.mailbox = arguments.flag("mailbox");
            if (options.mailbox && arguments.text("leaf") == "simd")
              throw Error("tunable-grid: mailbox=on goes with leaf=scalar only");
            if (auto simd = build_leaf_grid(arguments, input, options.rule, options.fit)) return simd;
            return std::make_unique<UniformGrid>(input, options);
          }};
}

}  // namespace raymeter
