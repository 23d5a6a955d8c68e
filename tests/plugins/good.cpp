// A plug-in that registers brute force under a name of its own.
#include "accel/per_ray_structure.h"
#include "accel/plugin.h"
#include "accel/primitive_test.h"

namespace {

class EveryPrimitive final : public raymeter::PerRayStructure<EveryPrimitive> {
 public:
  explicit EveryPrimitive(const raymeter::Scene& scene) : PerRayStructure(scene) {}

  template <class Probe>
  raymeter::Hit closest_hit(const raymeter::Ray& ray, Probe& probe) const {
    return raymeter::is_traceable(ray) ? raymeter::closest_of_all(scene(), ray, probe) : raymeter::Hit{};
  }
  template <class Probe>
  bool any_hit(const raymeter::Ray& ray, Probe& probe) const {
    return raymeter::is_traceable(ray) && raymeter::any_of_all(scene(), ray, probe);
  }
  raymeter::StructureStats stats() const override { return {}; }
};

void register_structures(raymeter::Registry& registry) {
  registry.add({.name = "good",
                .summary = "every primitive",
                .source = "the tests",
                .build = [](const raymeter::Arguments&, const raymeter::BuildInput& input) {
                  return std::make_unique<EveryPrimitive>(input.scene);
                }});
}

}  // namespace

RAYMETER_PLUGIN(register_structures);
