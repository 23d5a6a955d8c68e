#pragma once
// Records as a comparison would make them, for tests of reports.
#include <string>
#include <vector>

#include "accel/registry.h"
#include "harness/record.h"

namespace raymeter {

inline Registry report_registry() {
  Registry all;
  all.add({"grid", "", "", Answers::exact, {{"amount", ParameterType::number, "1", "", 0, 10}}, {}});
  all.add({"octree", "", "", Answers::exact, {}, {}});
  all.add({"embree",
           "",
           "",
           Answers::within_bound,
           {{"quality", ParameterType::choice, "medium", "", 0, 0, {"low", "medium", "high"}}},
           {}});
  return all;
}

/// A race that went well.
inline Record report_record(const std::string& scene, const std::string& spec, const std::string& batch,
                            double ratio) {
  Record r;
  r.key = scene + spec + batch;
  r.scene = scene;
  r.scene_hash = "0123456789abcdef";
  r.structure = spec.substr(0, spec.find(':'));
  r.spec = spec;
  r.baseline = "embree:quality=medium";
  r.batch = batch;
  r.query = "closest";
  r.order = "tiled";
  r.status = "ok";
  r.ray_hash = "r";
  r.reference_hash = r.hit_hash = "h";
  r.environment_id = "e1";
  r.primitives = 1000;
  r.rays = r.right = 76800;
  r.wrong = r.unexplained = r.not_given = 0;
  r.threads = 1;
  r.seed = 1;
  r.rounds = 5;
  r.ratio = ratio;
  r.ratio_low = 0.98 * ratio;
  r.ratio_high = 1.02 * ratio;
  r.spread = 0.01;
  r.mrays_per_s = 5 * ratio;
  r.baseline_mrays_per_s = 5;
  r.build_s = 0.01;
  r.build_low_s = 0.0099;
  r.build_high_s = 0.0101;
  r.bytes = 4'500'000;
  r.peak_bytes = 5'000'000;
  if (r.structure != "embree") {
    r.steps_per_ray = 20.5;
    r.tests_per_ray = 7.25;
    r.distinct_tests_per_ray = 5;
    r.empty_cell_steps_per_ray = 10;
    r.steps_p50 = 18;
    r.steps_p90 = 40;
    r.steps_p99 = 60;
    r.steps_max = 133;
    r.tests_p50 = 0;
    r.tests_p90 = 14;
    r.tests_p99 = 30;
    r.tests_max = 71;
  }
  return r;
}

/// Two ray kinds, with embree as the baseline, of each of the scenes.
inline std::vector<Record> report_records(const std::vector<std::string>& scenes) {
  std::vector<Record> records;
  for (const std::string& scene : scenes)
    for (const char* batch : {"primary", "shadow"}) {
      records.push_back(report_record(scene, "grid:amount=0.5", batch, 0.2));
      records.push_back(report_record(scene, "grid:amount=1", batch, 0.3));
      records.push_back(report_record(scene, "grid:amount=2", batch, 0.25));
      records.push_back(report_record(scene, "octree", batch, 0.1));
      records.push_back(report_record(scene, "embree:quality=medium", batch, 1.001));
      records.back().right = 76000;
      records.back().within_bound = 800;
    }
  return records;
}

}  // namespace raymeter
