// Structures of somebody else's, loaded at run time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "run_command.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

std::string plugin(const std::string& name) {
  return " --plugin " RAYMETER_TEST_PLUGINS "/" + name + ".so";
}

const std::string small =
    "compare soup:triangles=300 --baseline grid -r primary -r shadow --size 48x36 --rounds 3";

class Plugin : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("plugin_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string out() const { return " --out " + (folder_ / "records").string(); }
  std::vector<CsvRow> rows() const { return read_csv(folder_ / "records/records.csv"); }

  fs::path folder_;
};

TEST_F(Plugin, ItsStructureIsGradedLikeOurs) {
  const Outcome outcome = run(small + " -s good" + plugin("good") + out());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("\n  good "));
  ASSERT_EQ(rows().size(), 4u);
  for (const CsvRow& row : rows()) {
    EXPECT_EQ(row.at("right"), row.at("rays"));
    EXPECT_GT(std::stod(row.at("tests_per_ray")), 0);
  }
}

TEST_F(Plugin, WithoutSItIsAmongTheStructures) {
  EXPECT_THAT(run(small + plugin("good")).text, HasSubstr("\n  good "));
}

TEST_F(Plugin, AWrongKernelIsSeenAndIsStatusOne) {
  const Outcome outcome = run(small + " -s wrong" + plugin("wrong") + out());
  EXPECT_EQ(outcome.status, 1) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr(" WRONG"));
  EXPECT_GT(std::stod(rows().at(0).at("wrong")), 0);
}

TEST_F(Plugin, ARebuiltPluginNeverPassesForTheOldOne) {
  fs::create_directories(folder_);
  const fs::path copy = folder_ / "mine.so";
  fs::copy_file(RAYMETER_TEST_PLUGINS "/good.so", copy);
  const std::string command = small + " -s good --plugin " + copy.string() + out();
  ASSERT_EQ(run(command).status, 0);
  ASSERT_EQ(run(command).status, 0);
  ASSERT_EQ(rows().size(), 4u) << "the same plug-in: the run goes on from its records";
  std::ofstream(copy, std::ios::binary | std::ios::app) << "another build";
  ASSERT_EQ(run(command).status, 0);
  const auto all = rows();
  ASSERT_EQ(all.size(), 6u) << "its rows are measured again, those of the baseline are not";
  EXPECT_EQ(all[4].at("structure"), "good");
  EXPECT_NE(all[4].at("build_id"), all[0].at("build_id"));
  // The library's own id comes first.
  EXPECT_THAT(all[0].at("build_id"), testing::StartsWith(all[2].at("build_id") + "+"));
}

TEST_F(Plugin, ListShowsIt) {
  const Outcome outcome = run("list structures" + plugin("good"));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.text, HasSubstr("good: every primitive"));
}

TEST_F(Plugin, ABadOneIsOneLineAndStatusTwo) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"nosuch", "no such plug-in"},       {"no_entry", "RAYMETER_PLUGIN is missing"},
      {"other_abi", "built for Raymeter"}, {"throws", "no licence found"},
      {"taken", "'grid' is registered"},   {"nothing", "registers no structure"},
  };
  for (const auto& [name, message] : cases) {
    const Outcome outcome = run(small + plugin(name));
    EXPECT_EQ(outcome.status, 2) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(message));
    EXPECT_THAT(outcome.text, testing::StartsWith("raymeter: "));
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << outcome.text;
  }
}

}  // namespace
}  // namespace raymeter
