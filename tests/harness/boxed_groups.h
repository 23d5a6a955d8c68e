#pragma once
#include <algorithm>
#include <vector>

#include "accel/memory_meter.h"
#include "accel/per_ray_structure.h"
#include "accel/primitive_test.h"
#include "accel/registry.h"
#include "accel/walk_space.h"

/// Primitives in groups, in the order of the scene, each with its box: the least that can be called a
/// structure.
class BoxedGroups : public raymeter::PerRayStructure<BoxedGroups> {
 public:
  BoxedGroups(const raymeter::Scene& scene, std::uint32_t group_size, std::uint64_t memory_limit)
      : PerRayStructure(scene), meter_(memory_limit), groups_(raymeter::MeteredAllocator<Group>(meter_)) {
    const auto count = static_cast<std::uint32_t>(scene.primitive_count());
    for (std::uint32_t first = 0; first < count; first += group_size) {
      const std::uint32_t last = std::min(count, first + group_size);
      raymeter::Bounds box;
      for (std::uint32_t primitive = first; primitive < last; ++primitive)
        box.extend(scene.bounds_of(primitive));
      groups_.push_back({raymeter::WalkSpace(box), first, last});
    }
  }

  template <class Probe>
  raymeter::Hit closest_hit(const raymeter::Ray& ray, Probe& probe) const {
    raymeter::Hit best;
    visit(ray, probe, [&](std::uint32_t primitive, const raymeter::FilterRay& filter) {
      raymeter::test_closest(scene(), primitive, filter, best, probe);
      return false;
    });
    return best;
  }

  template <class Probe>
  bool any_hit(const raymeter::Ray& ray, Probe& probe) const {
    return visit(ray, probe, [&](std::uint32_t primitive, const raymeter::FilterRay& filter) {
      return raymeter::test_any(scene(), primitive, filter, probe);
    });
  }

  raymeter::StructureStats stats() const override {
    raymeter::StructureStats stats;
    stats.cells = groups_.size();
    stats.references = scene().primitive_count();
    stats.bytes = meter_.bytes();
    stats.peak_bytes = meter_.peak();
    return stats;
  }

 private:
  struct Group {
    raymeter::WalkSpace box;  // grown by a margin: a walk in double loses no hit in it
    std::uint32_t first, last;
  };

  /// Shows `test` the primitives of every group that the ray meets, until it returns true.
  template <class Probe, class Test>
  bool visit(const raymeter::Ray& ray, Probe& probe, Test test) const {
    if (!raymeter::is_traceable(ray)) return false;
    const raymeter::WalkRay walk(ray);
    const raymeter::FilterRay filter(ray);
    for (const Group& group : groups_) {
      const bool missed = !raymeter::too_far(walk, group.box) &&
                          raymeter::clip(walk, ray, group.box.low, group.box.high).empty();
      probe.inner_step();
      if (missed) continue;
      probe.cell_step(false);
      for (std::uint32_t primitive = group.first; primitive < group.last; ++primitive)
        if (test(primitive, filter)) return true;
    }
    return false;
  }

  raymeter::MemoryMeter meter_;
  raymeter::MeteredVector<Group> groups_;
};

inline void register_boxed_groups(raymeter::Registry& registry) {
  using raymeter::ParameterType;
  registry.add({.name = "boxed-groups",
                .summary = "primitives in groups, each with its box",
                .source = "the README of Raymeter",
                .parameters = {{"size", ParameterType::integer, "64", "primitives in a group", 1, 1e6}},
                .build = [](const raymeter::Arguments& arguments, const raymeter::BuildInput& input) {
                  return std::make_unique<BoxedGroups>(
                      input.scene, static_cast<std::uint32_t>(arguments.integer("size")), input.memory_limit);
                }});
}
