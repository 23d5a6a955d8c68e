#include "reports/record_diff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "report_records.h"

namespace raymeter {
namespace {

using testing::HasSubstr;

RecordDiff diff_of(const std::vector<Record>& before, const std::vector<Record>& after) {
  return diff_records(before, after, {{"e1", {{"cpu", "x"}}}, {"e2", {{"cpu", "y"}}}}, report_registry(),
                      0.1);
}

/// What changes when the first race, grid's on primary rays, is changed.
RecordDiff changed(const std::function<void(Record&)>& change) {
  const std::vector<Record> before = report_records({"a"});
  std::vector<Record> after = before;
  change(after[0]);
  return diff_of(before, after);
}

TEST(RecordDiff, NothingChangedIsNothingSaid) {
  const RecordDiff diff = changed([](Record&) {});
  EXPECT_TRUE(diff.changes.empty());
  EXPECT_FALSE(diff.worse());
  EXPECT_EQ(diff_text(diff), "10 races compared, 0 worse, 0 better, 0 other changes\n");
}

TEST(RecordDiff, CountersAndHashesAreExact) {
  const RecordDiff more = changed([](Record& r) { r.steps_per_ray = 20.500001; });
  EXPECT_TRUE(more.worse());
  EXPECT_THAT(diff_text(more),
              HasSubstr("Worse\n  a  grid:amount=0.5  primary\n    steps_per_ray 20.5 -> 20.5"));
  const RecordDiff fewer = changed([](Record& r) { r.tests_per_ray = 7; });
  EXPECT_FALSE(fewer.worse());
  EXPECT_THAT(diff_text(fewer), HasSubstr("Better\n"));
  const RecordDiff other_hits = changed([](Record& r) { r.hit_hash = "other"; });
  EXPECT_FALSE(other_hits.worse()) << "a float kernel's answers may change; a wrong one is graded so";
  EXPECT_THAT(diff_text(other_hits), HasSubstr("hit_hash h -> other"));
  EXPECT_TRUE(changed([](Record& r) { r.reference_hash = "other"; }).worse());
}

TEST(RecordDiff, WhatIsWorse) {
  const std::vector<std::function<void(Record&)>> worse{
      [](Record& r) { r.wrong = 1; },
      [](Record& r) { r.unexplained = 1; },
      [](Record& r) { r.not_given = 1; },
      [](Record& r) { r.right = 76799, r.tie = 1; },
      [](Record& r) { r.bytes = 4'500'001; },
      [](Record& r) { r.peak_bytes = 5'000'001; },
      [](Record& r) { r.tests_max = 72; },
      [](Record& r) { r.status = "failed"; },
      [](Record& r) { r.ray_hash = "other"; },
      [](Record& r) { r.scene_hash = "other"; },
      [](Record& r) { r.spec = "grid:amount=9"; },  // the race is missing
      [](Record& r) { r.ratio = 0.15, r.ratio_low = 0.14, r.ratio_high = 0.16; },
      [](Record& r) { r.build_s = 0.02, r.build_low_s = 0.019, r.build_high_s = 0.021; },
  };
  for (std::size_t i = 0; i < worse.size(); ++i) EXPECT_TRUE(changed(worse[i]).worse()) << i;
}

TEST(RecordDiff, OtherClassesOfAnswersAreSaidAndNotWorse) {
  for (const auto member : {&Record::within_bound, &Record::tie, &Record::edge, &Record::grazing,
                            &Record::at_limit, &Record::degenerate}) {
    std::vector<Record> before = report_records({"a"}), after = before;
    before[0].*member = 3;
    after[0].*member = 4;
    const RecordDiff diff = diff_of(before, after);
    EXPECT_FALSE(diff.worse());
    ASSERT_EQ(diff.changes.size(), 1u);
    EXPECT_THAT(diff.changes[0].what, HasSubstr(" 3 -> 4"));
  }
  EXPECT_FALSE(changed([](Record& r) { r.right = 76801; }).worse());
}

TEST(RecordDiff, BuildTimesWithoutAMedianAreNotCompared) {
  EXPECT_TRUE(changed([](Record& r) {
                r.build_s = {}, r.build_low_s = 0.019, r.build_high_s = 0.021;
              }).changes.empty());
}

TEST(RecordDiff, TimesWithinTheNoiseAreNoChange) {
  const std::vector<std::function<void(Record&)>> same{
      [](Record& r) { r.ratio = 0.18, r.ratio_low = 0.15, r.ratio_high = 0.197; },  // intervals overlap
      [](Record& r) {
        r.ratio = 0.193, r.ratio_low = 0.19, r.ratio_high = 0.1955;
      },  // apart, but less than 5%
      [](Record& r) { r.build_s = 0.013, r.build_low_s = 0.0129, r.build_high_s = 0.0135; },
      [](Record& r) { r.mrays_per_s = 0.1; },  // a slower machine: the ratio counts
      [](Record& r) { r.key = "other", r.build_id = "other"; },
  };
  for (std::size_t i = 0; i < same.size(); ++i) EXPECT_TRUE(changed(same[i]).changes.empty()) << i;
}

TEST(RecordDiff, TheBaselineAgainstItselfIsTheFloor) {
  std::vector<Record> before = report_records({"a"}), after = before;
  after[0].ratio = 0.17, after[0].ratio_low = 0.165, after[0].ratio_high = 0.175;
  EXPECT_TRUE(diff_of(before, after).worse());
  after[4].ratio = 0.8;  // embree on primary rays, against itself
  after[4].ratio_low = 0.7, after[4].ratio_high = 1.1;
  EXPECT_FALSE(diff_of(before, after).worse());
}

TEST(RecordDiff, OfOtherProcessorsOnlyCountersAreCompared) {
  const std::vector<Record> before = report_records({"a"});
  std::vector<Record> after = before;
  for (Record& record : after) {
    record.environment_id = "e2";
    record.ratio = record.ratio_low = record.ratio_high = 0.01;
  }
  const RecordDiff diff = diff_of(before, after);
  EXPECT_FALSE(diff.worse());
  EXPECT_THAT(diff_text(diff), HasSubstr("different processors"));
  after[0].steps_per_ray = 30;
  EXPECT_TRUE(diff_of(before, after).worse());
}

TEST(RecordDiff, NewRacesAndMendedOnesAreNotWorse) {
  std::vector<Record> before = report_records({"a"}), after = report_records({"a", "b"});
  before[0].status = "failed";
  const RecordDiff diff = diff_of(before, after);
  EXPECT_FALSE(diff.worse());
  EXPECT_THAT(diff_text(diff), HasSubstr("status failed -> ok"));
  EXPECT_THAT(diff_text(diff), HasSubstr("  b  octree  shadow\n    is new"));
}

}  // namespace
}  // namespace raymeter
