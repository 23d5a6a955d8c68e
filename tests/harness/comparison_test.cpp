#include "harness/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "baselines/register_baselines.h"
#include "boxed_groups.h"
#include "harness/environment.h"
#include "scenes/base/error.h"
#include "scenes/open_scene.h"

namespace raymeter {
namespace {

Registry full_registry() {
  Registry registry;
  register_accel(registry);
  register_baselines(registry);
  register_boxed_groups(registry);
  return registry;
}

ComparisonSettings quick_settings(const std::vector<std::string>& structures,
                                  const std::vector<std::string>& kinds) {
  ComparisonSettings settings;
  for (const std::string& text : structures) settings.structures.push_back(parse_spec(text));
  for (const std::string& text : kinds) settings.ray_kinds.push_back(parse_spec(text));
  settings.baseline = parse_spec("embree");
  settings.batches.size = {48, 36, false};
  settings.race.rounds = 3;
  settings.race.min_round_seconds = 0.001;
  return settings;
}

class Collector : public ComparisonObserver {
 public:
  void record(const Record& record) override { records.push_back(record); }
  void reference_refuted(std::string_view, std::size_t rays) override { refuted += rays; }
  const Record* finished(std::string_view key) override {
    const auto found = earlier.find(std::string(key));
    return found == earlier.end() ? nullptr : &found->second;
  }

  std::vector<Record> records;
  std::map<std::string, Record> earlier;
  std::size_t refuted = 0;
};

/// Finds hits a little too far away, in some rays.
class Liar : public PerRayStructure<Liar> {
 public:
  explicit Liar(const Scene& scene) : PerRayStructure(scene), truth_(scene, 64, 1 << 30) {}
  template <class Probe>
  Hit closest_hit(const Ray& ray, Probe& probe) const {
    Hit hit = truth_.closest_hit(ray, probe);
    if (hit.found() && hit.primitive % 4 == 0) hit.t = std::nextafter(hit.t, no_hit);
    return hit;
  }
  template <class Probe>
  bool any_hit(const Ray& ray, Probe& probe) const {
    return truth_.any_hit(ray, probe);
  }
  StructureStats stats() const override { return {}; }

 private:
  BoxedGroups truth_;
};

TEST(Comparison, EveryExactStructureIsRightOnEveryKindOfRay) {
  const Registry registry = full_registry();
  Collector collector;
  const Scene scene = open_scene("soup:triangles=3000:size=0.05");
  compare_structures(scene, registry,
                     quick_settings({"grid", "tunable-grid", "octree", "two-level-grid", "brick-grid",
                                     "counted-bvh", "boxed-groups"},
                                    {"primary", "shadow", "reflection", "diffuse", "ao", "random"}),
                     collector);
  EXPECT_EQ(collector.records.size(), 8u * 6u) << "seven structures and the baseline, six kinds of rays";
  EXPECT_EQ(collector.refuted, 0u);
  std::set<std::string> keys;
  for (const Record& record : collector.records) {
    SCOPED_TRACE(record.spec + " " + record.batch);
    EXPECT_TRUE(keys.insert(record.key).second);
    EXPECT_EQ(record.status, "ok");
    EXPECT_GT(record.hits, 0u);
    EXPECT_GE(record.rounds, 3u);
    if (record.structure != "embree") {
      EXPECT_EQ(record.right, record.rays);
    }
    EXPECT_EQ(record.wrong, 0u);
    EXPECT_EQ(record.unexplained, 0u);
    if (record.structure == "grid") {
      EXPECT_THAT(record.bytes_by_part, testing::MatchesRegex("cells=[0-9]+ references=[0-9]+"));
    }
  }
}

TEST(Comparison, TheDefaultsDoOnTeapot12WhatTheirPapersDescribe) {
  const std::string teapot = std::string(RAYMETER_SHARED_DATA) + "/scenes/spd/standard/teapot12.nff";
  if (!std::filesystem::exists(teapot)) GTEST_SKIP() << teapot << " is absent";
  const Registry registry = full_registry();
  Collector collector;
  const Scene scene = open_scene(teapot);
  compare_structures(scene, registry,
                     quick_settings({"octree", "two-level-grid", "grid"}, {"primary", "diffuse"}), collector);
  for (const Record& record : collector.records) {
    SCOPED_TRACE(record.spec + " " + record.batch);
    if (record.structure == "octree") {
      EXPECT_GT(record.point_locations_per_ray, 0);
    }
    if (record.structure == "two-level-grid") {
      EXPECT_GT(record.subgrids_entered_per_ray, 0);
    }
    if (record.structure == "grid") {
      EXPECT_EQ(record.point_locations_per_ray, 0);
      EXPECT_EQ(record.subgrids_entered_per_ray, 0);
    }
  }
}

TEST(Comparison, AnExactStructureThatIsOffByOneBitIsWrong) {
  Registry registry = full_registry();
  registry.add({.name = "liar", .build = [](const Arguments&, const BuildInput& input) {
                  return std::make_unique<Liar>(input.scene);
                }});
  Collector collector;
  const Scene scene = open_scene("soup:triangles=3000:size=0.05");
  compare_structures(scene, registry, quick_settings({"liar", "grid"}, {"primary"}), collector);
  ASSERT_EQ(collector.records.size(), 3u);
  EXPECT_GT(collector.records[0].wrong, 10u);
  EXPECT_EQ(*collector.records[0].right + *collector.records[0].wrong, collector.records[0].rays);
  EXPECT_EQ(collector.records[1].wrong, 0u) << "a liar must not spoil the truth for others";
  EXPECT_NE(collector.records[0].hit_hash, collector.records[1].hit_hash);
}

TEST(Comparison, AFailedBuildIsARecordAndTheOthersGoOn) {
  Registry registry = full_registry();
  registry.add(
      {.name = "broken", .build = [](const Arguments&, const BuildInput&) -> std::unique_ptr<Structure> {
         throw std::runtime_error("no luck today");
       }});
  Collector collector;
  const Scene scene = open_scene("soup:triangles=100");
  compare_structures(scene, registry, quick_settings({"broken", "grid"}, {"primary"}), collector);
  ASSERT_EQ(collector.records.size(), 3u);
  EXPECT_EQ(collector.records[0].status, "failed");
  EXPECT_EQ(collector.records[0].note, "no luck today");
  EXPECT_FALSE(collector.records[0].right.has_value());
  EXPECT_EQ(collector.records[1].status, "ok");
}

TEST(Comparison, WithoutABaselineThereIsNoRatio) {
  Registry registry = full_registry();
  registry.add(
      {.name = "broken", .build = [](const Arguments&, const BuildInput&) -> std::unique_ptr<Structure> {
         throw std::runtime_error("no luck today");
       }});
  ComparisonSettings settings = quick_settings({"grid"}, {"primary"});
  settings.baseline = parse_spec("broken");
  Collector collector;
  const Scene scene = open_scene("soup:triangles=100");
  compare_structures(scene, registry, settings, collector);
  ASSERT_EQ(collector.records.size(), 2u);
  EXPECT_EQ(collector.records[0].status, "ok");
  EXPECT_FALSE(collector.records[0].ratio.has_value());
  EXPECT_TRUE(collector.records[0].mrays_per_s.has_value());
  EXPECT_THAT(collector.records[0].note, testing::HasSubstr("no luck today"));
}

TEST(Comparison, RecordsSayWhereTheyWereMadeAndWhetherTheThreadWasHeld) {
  const Registry registry = full_registry();
  const Scene scene = open_scene("soup:triangles=100");
  ComparisonSettings settings = quick_settings({"embree"}, {"primary"});
  for (const unsigned threads : {1u, 2u}) {
    settings.race.threads = threads;
    Collector collector;
    compare_structures(scene, registry, settings, collector);
    ASSERT_EQ(collector.records.size(), 1u);
    EXPECT_EQ(collector.records[0].environment_id, environment_id());
    EXPECT_THAT(collector.records[0].pinned,
                threads == 1 ? testing::AnyOf("yes", "no") : testing::AnyOf("", ""));
  }
}

TEST(Comparison, FinishedRecordsAreNotMeasuredAgain) {
  const Registry registry = full_registry();
  const Scene scene = open_scene("soup:triangles=100");
  const ComparisonSettings settings = quick_settings({"grid", "octree"}, {"primary", "random"});
  Collector first, second;
  compare_structures(scene, registry, settings, first);
  for (const Record& record : first.records) second.earlier[record.key] = record;
  second.earlier.begin()->second.note = "kept";
  compare_structures(scene, registry, settings, second);
  ASSERT_EQ(second.records.size(), first.records.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < first.records.size(); ++i) {
    EXPECT_EQ(second.records[i].key, first.records[i].key);
    EXPECT_EQ(second.records[i].mrays_per_s, first.records[i].mrays_per_s) << "measured again";
    kept += second.records[i].note == "kept";
  }
  EXPECT_EQ(kept, 1u);
}

TEST(Comparison, EmptyScenesAndBatchesAreCompared) {
  const Registry registry = full_registry();
  SceneData nothing;
  nothing.name = "nothing";
  Collector collector;
  compare_structures(
      Scene(nothing), registry,
      quick_settings({"grid", "tunable-grid", "octree", "two-level-grid", "counted-bvh", "brute-force"},
                     {"primary", "shadow", "random"}),
      collector);
  EXPECT_EQ(collector.records.size(), 7u * 3u);
  for (const Record& record : collector.records) {
    SCOPED_TRACE(record.spec + " " + record.batch);
    EXPECT_EQ(record.status, "ok") << record.note;
    EXPECT_EQ(record.hits, 0u);
    EXPECT_EQ(record.right, record.rays);
  }
}

/// The one of this structure and batch.
const Record& record_of(const Collector& collector, std::string_view structure, std::string_view batch) {
  static const Record none;
  for (const Record& record : collector.records)
    if (record.structure == structure && record.batch == batch) return record;
  ADD_FAILURE() << "no record of " << structure << " on " << batch;
  return none;
}

TEST(Comparison, AWhittedRenderingHasARowForEachGenerationAndForAll) {
  const Registry registry = full_registry();
  const Scene scene = open_scene("soup:triangles=300:size=0.3");  // Ks 0.2: all surfaces mirror
  const ComparisonSettings settings = quick_settings({"grid"}, {"whitted:depth=2"});
  Collector first;
  compare_structures(scene, registry, settings, first);
  const char* all = "whitted:depth=2:rays=all";
  std::vector<std::string> batches;
  for (const Record& record : first.records)
    if (record.structure == "grid") batches.push_back(record.batch);
  EXPECT_THAT(batches, testing::ElementsAre("whitted:depth=2:rays=primary", "whitted:depth=2:rays=shadow-1",
                                            "whitted:depth=2:rays=reflection-2",
                                            "whitted:depth=2:rays=shadow-2", all));
  EXPECT_EQ(first.records.size(), 10u);
  const Record& sum = record_of(first, "grid", all);
  std::uint64_t rays = 0, hits = 0, right = 0;
  double seconds = 0, tests = 0;
  for (const Record& record : first.records) {
    if (record.structure != "grid" || record.batch == all) continue;
    EXPECT_EQ(record.right, record.rays) << record.batch;
    rays += *record.rays;
    hits += *record.hits;
    right += *record.right;
    seconds += double(*record.rays) / *record.mrays_per_s;
    tests += *record.tests_per_ray * double(*record.rays);
  }
  EXPECT_EQ(sum.rays, rays);
  EXPECT_EQ(sum.hits, hits);
  EXPECT_EQ(sum.right, right);
  EXPECT_EQ(sum.query, "closest and any");
  EXPECT_NEAR(*sum.tests_per_ray, tests / double(rays), 1e-9 * tests);
  EXPECT_GT(*sum.mrays_per_s, 0.5 * double(rays) / seconds);
  EXPECT_LT(*sum.mrays_per_s, 2 * double(rays) / seconds);
  EXPECT_EQ(sum.rounds, 3u);
  EXPECT_LE(*sum.ratio_low, *sum.ratio);
  EXPECT_NE(sum.hit_hash, record_of(first, "grid", batches[0]).hit_hash);
  EXPECT_EQ(sum.hit_hash, sum.reference_hash);
  EXPECT_EQ(sum.ray_hash, record_of(first, "embree", all).ray_hash);

  // A run that was killed before the last row goes on from its other rows.
  Collector second;
  for (const Record& record : first.records) second.earlier[record.key] = record;
  second.earlier.erase(sum.key);
  compare_structures(scene, registry, settings, second);
  ASSERT_EQ(second.records.size(), 10u);
  EXPECT_EQ(record_of(second, "grid", batches[1]).mrays_per_s,
            record_of(first, "grid", batches[1]).mrays_per_s);
  EXPECT_EQ(record_of(second, "grid", all).rays, rays);
  EXPECT_EQ(record_of(second, "grid", all).hit_hash, sum.hit_hash);
}

TEST(Comparison, OneGenerationOfAWhittedRenderingCanBeAskedFor) {
  const Registry registry = full_registry();
  const Scene scene = open_scene("soup:triangles=300:size=0.3");
  Collector collector;
  compare_structures(scene, registry, quick_settings({"grid"}, {"whitted:depth=3:rays=reflection-3"}),
                     collector);
  ASSERT_EQ(collector.records.size(), 2u);
  EXPECT_EQ(collector.records[0].batch, "whitted:depth=3:rays=reflection-3");
  try {
    compare_structures(scene, registry, quick_settings({"grid"}, {"whitted:depth=2:rays=refraction-2"}),
                       collector);
    ADD_FAILURE() << "there is no glass in it";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("has no rays 'refraction-2'; it has: all, primary, shadow-1, "
                                   "reflection-2, shadow-2"));
  }
}

TEST(Comparison, WhatCanNotBeBuiltFailsInEveryGeneration) {
  const Registry registry = full_registry();
  ComparisonSettings settings = quick_settings({"grid"}, {"whitted:depth=1"});
  settings.memory_limit = 100;
  Collector collector;
  compare_structures(open_scene("soup:triangles=300:size=0.3"), registry, settings, collector);
  int failed = 0;
  for (const Record& record : collector.records)
    if (record.structure == "grid") failed += record.status == "failed";
  EXPECT_EQ(failed, 3) << "primary, shadow-1, all";
}

TEST(Comparison, TheReadmeShowsThisExample) {
  const auto text = [](const char* file) {
    std::ostringstream content;
    content << std::ifstream(std::string(RAYMETER_TEST_DATA) + "/../../" + file).rdbuf();
    return content.str();
  };
  const std::string example = text("tests/harness/boxed_groups.h");
  ASSERT_FALSE(example.empty());
  EXPECT_THAT(text("README.md"), testing::HasSubstr(example.substr(example.find("/// Primitives in groups"))))
      << "copy tests/harness/boxed_groups.h into the README";
}

TEST(Comparison, AFaultIsWhatAStructureCanBeBlamedFor) {
  const StructureKind exact{.name = "exact", .build = {}};
  const StructureKind bound{.name = "bound", .answers = Answers::within_bound, .build = {}};
  const StructureKind embree{.name = "e", .answers = Answers::within_bound, .build = {}, .tolerated = true};
  const auto faults = [&](const Record& record) {
    return std::array{is_fault(record, exact), is_fault(record, bound), is_fault(record, embree)};
  };
  using Faults = std::array<bool, 3>;
  Record record;
  record.status = "ok";
  record.within_bound = record.edge = record.tie = 5;
  EXPECT_EQ(faults(record), (Faults{false, false, false}));
  record.not_given = 1;
  EXPECT_EQ(faults(record), (Faults{true, false, false}));
  record.not_given = 0;
  record.unexplained = 1;
  EXPECT_EQ(faults(record), (Faults{true, true, false}));
  record.unexplained = 0;
  record.wrong = 1;
  EXPECT_EQ(faults(record), (Faults{true, true, false}));
  record.wrong = 0;
  record.status = "failed";
  EXPECT_EQ(faults(record), (Faults{true, true, false}));
  record.status = "inconsistent";
  EXPECT_EQ(faults(record), (Faults{true, true, true}));
}

TEST(Comparison, WithoutSettingsEverythingButBruteForceIsCompared) {
  ComparisonSettings settings;
  settings.batches.size = {8, 6, false};
  settings.race.rounds = 3;
  settings.race.min_round_seconds = 0.0001;
  Collector collector;
  const Registry registry = full_registry();
  compare_structures(open_scene("soup:triangles=20"), registry, settings, collector);
  std::set<std::string> structures, batches;
  for (const Record& record : collector.records) {
    structures.insert(record.structure);
    batches.insert(record.batch);
  }
  EXPECT_EQ(structures.size(), registry.kinds().size() - 1);
  EXPECT_EQ(structures.count("brute-force"), 0u);
  EXPECT_EQ(batches, (std::set<std::string>{"primary", "shadow", "reflection", "diffuse:samples=1"}));
}

}  // namespace
}  // namespace raymeter
