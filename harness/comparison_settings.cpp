#include "harness/comparison_settings.h"

#include <utility>

#include "harness/ray_file.h"
#include "harness/ray_kinds.h"

namespace raymeter {

void check(const ComparisonSettings& settings, const Registry& registry) {
  for (const Spec& spec : settings.structures) registry.arguments(spec);
  registry.arguments(settings.baseline);
  for (const Spec& kind : settings.ray_kinds) ray_arguments(kind);
}

std::vector<Spec> structures_of(const ComparisonSettings& settings, const Registry& registry) {
  std::vector<Spec> specs = settings.structures;
  if (specs.empty())
    for (const StructureKind& kind : registry.kinds())
      if (kind.name != "brute-force") specs.push_back({kind.name, {}});
  return specs;
}

std::vector<Arguments> ray_kinds_of(const ComparisonSettings& settings) {
  std::vector<Spec> specs = settings.ray_kinds;
  if (specs.empty() && settings.ray_files.empty())
    specs = {{"primary", {}}, {"shadow", {}}, {"reflection", {}}, {"diffuse", {}}};
  std::vector<Arguments> kinds;
  for (const Spec& spec : specs) kinds.push_back(ray_arguments(spec));
  return kinds;
}

std::vector<BatchGroup> make_batches(const Scene& scene, const Registry& registry,
                                     const ComparisonSettings& settings, const ReferenceRefuted& refuted) {
  std::vector<RayBatch> from_files;  // first: a file that can't be used is to cost nothing
  for (const auto& file : settings.ray_files) from_files.push_back(read_ray_file(file, scene));
  BatchJudge judge(scene, registry, settings.batches, settings.race.threads, refuted);
  std::vector<BatchGroup> groups;
  for (const Arguments& kind : ray_kinds_of(settings)) groups.push_back(judge.batches(kind));
  for (RayBatch& rays : from_files) groups.push_back({{judge.judged(std::move(rays))}, {}});
  return groups;
}

}  // namespace raymeter
