// raymeter report, end to end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run_command.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ReportCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("report_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// A small comparison.
  Outcome compare(const std::string& name, const std::string& more = "") const {
    return run(
        "compare soup:triangles=500 -s grid:amount=0.5,1,2 -s octree -r primary --size 32x24 --rounds 3 "
        "--time-budget 0.1 --out " +
        path(name) + " " + more);
  }

  std::filesystem::path folder_;
};

TEST_F(ReportCommand, ComparisonsLeaveAPageAndItCanBeMadeAgain) {
  const Outcome compared = compare("run");
  ASSERT_EQ(compared.status, 0) << compared.text;
  EXPECT_THAT(compared.text, HasSubstr("5 records and report.html in " + path("run")));
  const std::string page = content(folder_ / "run/report.html");
  EXPECT_THAT(page, HasSubstr("What traces soup:triangles=500 fastest"));
  EXPECT_THAT(page, HasSubstr("grid over amount"));

  const Outcome again = run("report " + path("run") + " -o " + path("again.html"));
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.text, path("again.html") + "\n");
  EXPECT_EQ(content(folder_ / "again.html"), page);
}

TEST_F(ReportCommand, WritesTablesAndJoinsFolders) {
  ASSERT_EQ(compare("one").status, 0);
  ASSERT_EQ(compare("two", "--seed 2").status, 0);
  const std::string both = "report " + path("one") + " " + path("two") + " -o ";
  EXPECT_EQ(run(both + path("t.md")).status, 0);
  EXPECT_THAT(content(folder_ / "t.md"), StartsWith("# What traces soup:triangles=500 fastest"));
  EXPECT_THAT(content(folder_ / "t.md"), HasSubstr("(seed 2)"));
  EXPECT_EQ(run(both + path("t.tex")).status, 0);
  EXPECT_THAT(content(folder_ / "t.tex"), HasSubstr("\\toprule"));
  EXPECT_EQ(run(both + path("t.csv")).status, 0);
  EXPECT_EQ(read_csv(folder_ / "t.csv").size(), 10u);
}

TEST_F(ReportCommand, DiffIsStatusOneWhenSomethingGotWorse) {
  ASSERT_EQ(compare("old").status, 0);
  std::filesystem::copy(path("old"), path("new"));
  const Outcome same = run("report --diff " + path("old") + " " + path("new"));
  EXPECT_EQ(same.status, 0);
  EXPECT_EQ(same.text, "5 races compared, 0 worse, 0 better, 0 other changes\n");

  std::string records = content(folder_ / "new/records.jsonl");
  const std::string key = "\"tests_per_ray\":";
  records.insert(records.find(key) + key.size(), "1");  // ten times as many, or more
  std::ofstream(folder_ / "new/records.jsonl", std::ios::binary) << records;
  const Outcome worse = run("report --diff " + path("old") + " " + path("new"));
  EXPECT_EQ(worse.status, 1);
  EXPECT_THAT(worse.text, HasSubstr("soup:triangles=500  grid:amount=0.5  primary\n    tests_per_ray"));
  EXPECT_EQ(run("report --diff " + path("new") + " " + path("old")).status, 0)
      << "the other way round it got better";
}

TEST_F(ReportCommand, BadUsageIsOneLineAndStatusTwo) {
  ASSERT_EQ(compare("run").status, 0);
  std::ofstream(folder_ / "bad.jsonl") << "";
  std::filesystem::create_directories(folder_ / "bad");
  std::ofstream(folder_ / "bad/records.jsonl") << "no record\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"report", "folder"},
      {"report " + path("none"), "no records.jsonl"},
      {"report " + path("bad"), "records.jsonl:1: not a record"},
      {"report " + path("run") + " -o " + path("x.pdf"), ".html, .md, .tex or .csv"},
      {"report " + path("run") + " -o " + path("no/x.html"), "can't be written"},
      {"report --diff " + path("run"), "two folders"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(message)) << arguments;
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << outcome.text;
  }
}

}  // namespace
}  // namespace raymeter
