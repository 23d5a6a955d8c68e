#include "reports/sweeps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report_records.h"
#include "reports/report_tables.h"

namespace raymeter {
namespace {

using testing::ElementsAre;

TEST(Sweeps, AreParametersWithThreeNumbersAndTheRestFixed) {
  const Report report = make_report(report_records({"a"}), {}, report_registry());
  const std::vector<Sweep> found = structure_sweeps(report, report.sections[0]);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].parameter, "amount");
  EXPECT_THAT(found[0].values, ElementsAre(0.5, 1, 2));
  EXPECT_THAT(found[0].indices, ElementsAre(0, 1, 2));
  EXPECT_EQ(found[0].fixed, "");
}

TEST(Sweeps, OverTwoParametersAreAFamilyOfCurves) {
  std::vector<Record> records;
  for (const char* spec :
       {"t:a=4:b=on", "t:a=4:b=off", "t:a=1:b=on", "t:a=1:b=off", "t:a=2:b=on", "t:a=2:b=off"})
    records.push_back(report_record("s", spec, "primary", 1));
  const Report report = make_report(records, {}, report_registry());
  const std::vector<Sweep> found = structure_sweeps(report, report.sections[0]);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].fixed, "b=off");
  EXPECT_THAT(found[0].values, ElementsAre(1, 2, 4));
  EXPECT_EQ(found[1].fixed, "b=on");
}

TEST(Sweeps, OfScenesAreTheirParameters) {
  const Report report = make_report(
      report_records({"soup:triangles=4000:size=0.02:seed=1", "bunny.ply",
                      "soup:triangles=1000:size=0.02:seed=1", "soup:triangles=2000:size=0.02:seed=1",
                      "soup:triangles=2000:size=0.02:seed=2", "odd:=,"}),
      {}, report_registry());
  const std::vector<Sweep> found = scene_sweeps(report);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].parameter, "triangles");
  EXPECT_EQ(found[0].fixed, "seed=1");
  EXPECT_THAT(found[0].values, ElementsAre(1000, 2000, 4000));
  EXPECT_THAT(found[0].indices, ElementsAre(2, 3, 0));
  EXPECT_EQ(scene_sweep_table(report, found[0]).rows.size(), 3u * 5u * 2u);
}

}  // namespace
}  // namespace raymeter
