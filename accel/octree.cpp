#include "accel/octree.h"

#include <cmath>
#include <optional>

#include "accel/cell_query.h"
#include "accel/octree_cells.h"
#include "accel/octree_glassner.h"
#include "accel/octree_top_down.h"
#include "accel/per_ray_structure.h"

namespace raymeter {
namespace {

/// `Nodes` is GlassnerOctree or TopDownOctree.
template <class Nodes>
class Octree final : public PerRayStructure<Octree<Nodes>> {
 public:
  Octree(const Scene& scene, std::uint32_t leaf, int depth, std::uint64_t memory_limit)
      : PerRayStructure<Octree<Nodes>>(scene), meter_(memory_limit) {
    OctreeCells tree = build_octree_cells(scene, leaf, depth, meter_);
    if (tree.nodes.empty()) return;
    const Vec3d extent = tree.space.scene.extent();
    const double cell = std::ldexp(tree.space.cell, depth - tree.depth);
    for (int axis = 0; axis < 3; ++axis)
      stats_.resolution[static_cast<std::size_t>(axis)] =
          static_cast<std::uint32_t>(std::ceil(extent[axis] / cell));
    stats_.cells = tree.leaves;
    stats_.empty_cells = tree.empty_leaves;
    stats_.inner_nodes = tree.inner_nodes;
    stats_.references = tree.references.size();
    stats_.depth = static_cast<std::uint32_t>(tree.depth);
    stats_.note = tree.note;

    space_ = tree.space.scene;
    nodes_.emplace(std::move(tree), meter_);
  }

  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    return answer<ClosestQuery<NoMailbox, Probe>>(ray, probe);
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return answer<AnyQuery<NoMailbox, Probe>>(ray, probe);
  }

  StructureStats stats() const final {
    StructureStats stats = stats_;
    stats.bytes = meter_.bytes();
    stats.peak_bytes = meter_.peak();
    if (nodes_) stats.bytes_by_part = nodes_->bytes_by_part();
    return stats;
  }

 private:
  template <class Query, class Probe>
  typename Query::Answer answer(const Ray& ray, Probe& probe) const {
    if (!nodes_) return {};
    return answer_by_walk<Query>(this->scene(), space_, ray, probe,
                                 [&](const WalkRay& walk_ray, const WalkInterval& interval, Query& query) {
                                   nodes_->walk(walk_ray, interval, query, probe);
                                 });
  }

  MemoryMeter meter_;
  std::optional<Nodes> nodes_;  // none in an empty scene
  WalkSpace space_;
  StructureStats stats_;
};

std::unique_ptr<Structure> build_octree(const Arguments& arguments, const BuildInput& input) {
  const auto leaf = static_cast<std::uint32_t>(arguments.integer("leaf"));
  const auto depth = static_cast<int>(arguments.integer("depth"));
  if (arguments.text("traversal") == "glassner")
    return std::make_unique<Octree<GlassnerOctree>>(input.scene, leaf, depth, input.memory_limit);
  return std::make_unique<Octree<TopDownOctree>>(input.scene, leaf, depth, input.memory_limit);
}

}  // namespace

StructureKind octree_kind() {
  return {
      .name = "octree",
      .summary =
          "cells split in 8 while they are crowded; nodes in a hash table, points located from the root",
      .source = "Glassner 1984; top-down: Revelles, Urena and Lastra 2000",
      .answers = Answers::exact,
      .parameters = {{"leaf", ParameterType::integer, "8",
                      "primitives that a cell may hold without being split", 1, 1e6},
                     {"depth", ParameterType::integer, "14", "levels below the root, at most", 0, 20},
                     {.name = "traversal",
                      .type = ParameterType::choice,
                      .default_value = "glassner",
                      .meaning = "point location from the root for each cell, or one descent with a stack",
                      .choices = {"glassner", "top-down"}}},
      .build = build_octree};
}

}  // namespace raymeter
