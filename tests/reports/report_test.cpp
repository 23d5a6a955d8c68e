#include "reports/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report_records.h"

namespace raymeter {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

Report report_of(const std::vector<Record>& records) {
  return make_report(records, {{"e1", {{"cpu", "a"}}}, {"e2", {{"cpu", "b"}}}}, report_registry());
}

TEST(Report, HasASectionForEachSceneWithBriefNames) {
  const Report report = report_of(report_records({"soup:triangles=60000:size=0.02:seed=1", "b.nff"}));
  ASSERT_EQ(report.sections.size(), 2u);
  EXPECT_EQ(report.sections[0].title, "soup");
  EXPECT_EQ(report.sections[1].title, "b.nff");
  EXPECT_EQ(report.sections[0].setting, "");
  EXPECT_THAT(report.sections[0].specs, ElementsAre(0, 1, 2, 3, 4));
  EXPECT_EQ(report.specs[1].label, "grid");
  EXPECT_EQ(report.specs[0].label, "grid:amount=0.5");
  EXPECT_EQ(report.specs[4].label, "embree");
  EXPECT_EQ(report.sections[0].baseline, 4u);
}

TEST(Report, WhatIsNotMeasuredAlikeStandsApartAndSaysWhy) {
  Record two_threads = report_record("a", "grid:amount=1", "primary", 0.3);
  two_threads.threads = 2;
  Record elsewhere = report_record("a", "grid:amount=1", "primary", 0.3);
  elsewhere.environment_id = "e2";
  const Report report =
      report_of({report_record("a", "grid:amount=1", "primary", 0.3), two_threads, elsewhere});
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_EQ(report.sections[0].setting, "threads 1, environment 1");
  EXPECT_EQ(report.sections[1].setting, "threads 2, environment 1");
  EXPECT_EQ(report.sections[2].setting, "threads 1, environment 2");
}

TEST(Report, TheLaterOfTwoRecordsWithOneKeyCountsAndOtherwiseBothAreShown) {
  Record later = report_record("a", "octree", "primary", 0.5);
  Record other_key = report_record("a", "octree", "primary", 0.7);
  other_key.key = "another";
  const Report report = report_of({report_record("a", "octree", "primary", 0.3), later, other_key});
  ASSERT_EQ(report.sections.size(), 2u);
  EXPECT_EQ(report.sections[0].records[0].ratio, 0.5);
  EXPECT_EQ(report.sections[1].records[0].ratio, 0.7);
  EXPECT_EQ(report.sections[1].setting, "run 2");
}

TEST(Report, AStructureHasOneColourWhateverElseIsThere) {
  const Report one = report_of({report_record("a", "octree", "primary", 1)});
  const Report all = report_of(report_records({"a"}));
  EXPECT_EQ(one.specs[0].colour, all.specs[3].colour);
  EXPECT_EQ(all.specs[0].colour, all.specs[2].colour);
  EXPECT_NE(all.specs[0].colour, all.specs[3].colour);
}

TEST(Report, StructuresThatNobodyKnowsKeepTheirSpecs) {
  const Report report = report_of({report_record("a", "mine:x=1", "strange:y=2", 1)});
  EXPECT_EQ(report.specs[0].label, "mine:x=1");
  EXPECT_EQ(report.batches[0].label, "strange:y=2");
}

TEST(MeanRatio, IsGeometricAndOnlyOfWhatRanOnAllRays) {
  std::vector<Record> records{report_record("a", "octree", "primary", 0.1),
                              report_record("a", "octree", "shadow", 0.4),
                              report_record("a", "grid:amount=1", "primary", 0.1)};
  const Report report = report_of(records);
  const auto mean = mean_ratio(report.sections[0], 0);
  ASSERT_TRUE(mean);
  EXPECT_THAT(mean->value, DoubleEq(0.2));
  EXPECT_THAT(mean->low, DoubleEq(0.98 * 0.2));
  EXPECT_EQ(mean->races, 2u);
  EXPECT_FALSE(mean_ratio(report.sections[0], 1));
}

TEST(Envelope, IsTheBestOfTheBaselinesKindWhereThereAreSeveral) {
  std::vector<Record> records = report_records({"a"});
  EXPECT_EQ(envelope(report_of(records), report_of(records).sections[0], 0), nullptr);
  records.push_back(report_record("a", "embree:quality=high", "primary", 1.3));
  const Report report = report_of(records);
  EXPECT_EQ(envelope(report, report.sections[0], 0)->spec, "embree:quality=high");
}

}  // namespace
}  // namespace raymeter
