#include "reports/comparison_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace raymeter {
namespace {

using testing::HasSubstr;

Registry registry() {
  Registry all;
  all.add({"grid", "", "", Answers::exact, {{"amount", ParameterType::number, "1", "", 0, 10}}, {}});
  all.add({"embree", "", "", Answers::within_bound, {}, {}});
  return all;
}

Record row(const std::string& spec) {
  Record record;
  record.scene = "soup:triangles=1000";
  record.scene_hash = "0123456789abcdef";
  record.spec = spec;
  record.baseline = "embree";
  record.batch = "primary";
  record.query = "closest";
  record.order = "tiled";
  record.status = "ok";
  record.primitives = 1000;
  record.rays = record.right = 76800;
  record.rounds = 5;
  record.ratio = 0.5;
  record.ratio_low = 0.49;
  record.ratio_high = 0.51;
  record.mrays_per_s = 1.25;
  record.build_s = 0.0123;
  record.bytes = 4'500'000;
  return record;
}

TEST(ComparisonTable, FitsAHundredColumnsWhateverTheNames) {
  Record wide = row("grid:amount=1.2345678901234567");
  wide.note = std::string(60, 'x') + " " + std::string(70, 'y') + " clamped from 99999x99999x99999 to 1x1x1";
  wide.spec = "grid:amount=1.2345678901234567";
  wide.ratio = 123.456;
  wide.ratio_low = 100.123;
  wide.ratio_high = 130.123;
  wide.mrays_per_s = 12345.6;
  wide.build_s = 123.456;
  wide.bytes = 123'456'000'000;
  wide.steps_per_ray = 123456.7;
  wide.tests_per_ray = 1234567.8;
  std::istringstream lines(comparison_table(std::vector{wide}, registry()));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
}

TEST(ComparisonTable, ShowsValuesAndBriefSpecs) {
  Record record = row("grid:amount=2");
  record.steps_per_ray = 23.04;
  const std::string text = comparison_table(std::vector{record, row("grid:amount=1")}, registry());
  EXPECT_THAT(text, HasSubstr("grid:amount=2 "));
  EXPECT_THAT(text, HasSubstr("\n  grid "));
  EXPECT_THAT(text, HasSubstr("0.490..0.510"));
  EXPECT_THAT(text, HasSubstr("12.3"));
  EXPECT_THAT(text, HasSubstr("4.50"));
  EXPECT_THAT(text, HasSubstr("23.0"));
  EXPECT_THAT(text, HasSubstr("right"));
}

TEST(ComparisonTable, SaysWhatNumbersWouldHide) {
  Record embree = row("embree");
  embree.right = 76797;
  embree.edge = 2;
  embree.tie = 1;
  Record wrong = row("grid:amount=1");
  wrong.right = 76790;
  wrong.wrong = 10;
  wrong.noisy = "yes";
  wrong.spread = 0.25;
  Record failed = row("grid:amount=3");
  failed.status = "failed";
  failed.ratio = failed.ratio_low = failed.ratio_high = failed.mrays_per_s = failed.build_s = {};
  failed.note = "needs 8.1 MB or more, 8.0 MB are allowed";
  const std::string text = comparison_table(std::vector{embree, wrong, failed}, registry());
  EXPECT_THAT(text, HasSubstr("explained"));
  EXPECT_THAT(text, HasSubstr("embree differs from the truth: primary: 1 tie, 2 edge"));
  EXPECT_THAT(text, HasSubstr("10 WRONG"));
  EXPECT_THAT(text, HasSubstr("grid primary 25%"));
  EXPECT_THAT(text, HasSubstr("failed"));
  EXPECT_THAT(text, HasSubstr("needs 8.1 MB"));
}

TEST(ComparisonTable, NamesWhatIsNotRight) {
  const auto graded = [](Record::Count Record::* member) {
    Record record = row("grid:amount=1");
    record.right = 76790;
    record.*member = 10;
    return comparison_table(std::vector{record}, registry());
  };
  EXPECT_THAT(graded(&Record::wrong), HasSubstr(" 10 WRONG\n"));
  EXPECT_THAT(graded(&Record::unexplained), HasSubstr(" 10 unexamined\n"));
  EXPECT_THAT(graded(&Record::not_given), HasSubstr(" 10 not given\n"));
  EXPECT_THAT(graded(&Record::tie), HasSubstr(" explained\n"));
}

TEST(ComparisonTable, TellsSweptStructuresApart) {
  const std::string text = comparison_table(
      std::vector{row("grid:amount=1.23456789012345"), row("grid:amount=1.23456789012346")}, registry());
  EXPECT_THAT(text, HasSubstr("grid:amount=1.23456789012345\n"));
  EXPECT_THAT(text, HasSubstr("grid:amount=1.23456789012346\n"));
}

TEST(ComparisonTable, ShowsHowSmallARatioIs) {
  Record slow = row("grid:amount=1");
  slow.ratio = 0.00012;
  EXPECT_THAT(comparison_table(std::vector{slow}, registry()), HasSubstr("1.2e-04"));
}

TEST(ComparisonTable, NoRecordsNoTable) {
  EXPECT_EQ(comparison_table({}, registry()), "");
}

}  // namespace
}  // namespace raymeter
