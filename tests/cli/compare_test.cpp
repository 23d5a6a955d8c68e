// The command, end to end: exit status, what it prints, what it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "run_command.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
using testing::Not;

class Compare : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("compare_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string out() const { return " --out " + folder_.string(); }

  std::filesystem::path folder_;
};

const std::string small = "compare soup:triangles=2000:size=0.05 --size 64x48 --rounds 3";

TEST_F(Compare, DefaultsRaceAllStructuresOverFourKindsOfRays) {
  const Outcome outcome = run(small + out());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  for (const char* name :
       {"grid ", "tunable-grid", "octree", "two-level-grid", "brick-grid", "embree", "counted-bvh"})
    EXPECT_THAT(outcome.text, HasSubstr(std::string("\n  ") + name));
  for (const std::string& line : lines_of(outcome.text)) EXPECT_LE(line.size(), 100u) << line;
  EXPECT_THAT(outcome.text, Not(HasSubstr("\r"))) << "a progress bar without a terminal";

  const auto rows = read_csv(folder_ / "records.csv");
  EXPECT_EQ(rows.size(), 7u * 4u);
  std::map<std::string, std::string> hashes;
  for (const CsvRow& row : rows) {
    SCOPED_TRACE(row.at("spec") + " " + row.at("batch"));
    EXPECT_EQ(row.at("status"), "ok");
    // Every structure got the same rays, and every exact one gave the true answers.
    EXPECT_EQ(hashes.emplace(row.at("batch"), row.at("ray_hash")).first->second, row.at("ray_hash"));
    if (row.at("structure") != "embree") {
      EXPECT_EQ(row.at("hit_hash"), row.at("reference_hash"));
      EXPECT_EQ(row.at("right"), row.at("rays"));
      EXPECT_GT(std::stod(row.at("tests_per_ray")), 0);
      EXPECT_GT(std::stod(row.at("steps_per_ray")), 0);
    } else {
      EXPECT_EQ(row.at("tests_per_ray"), "") << "Embree can't be counted in: the field must be empty, not 0";
      EXPECT_FALSE(row.at("isa").empty());
    }
    double sum = 0;
    for (const char* grade : {"right", "within_bound", "tie", "edge", "grazing", "at_limit", "degenerate",
                              "wrong", "not_given", "unexplained"})
      sum += std::stod(row.at(grade));
    EXPECT_EQ(sum, std::stod(row.at("rays")));
    EXPECT_GT(std::stod(row.at("mrays_per_s")), 0);
    EXPECT_LE(std::stod(row.at("ratio_low")), std::stod(row.at("ratio")));
    EXPECT_GE(std::stod(row.at("ratio_high")), std::stod(row.at("ratio")));
    EXPECT_GE(std::stod(row.at("brute_forced")), std::min(4096.0, std::stod(row.at("rays"))));
  }
  EXPECT_THAT(content(folder_ / "environment.json"), HasSubstr("compiler"));
  for (const CsvRow& row : rows) {
    EXPECT_THAT(content(folder_ / "environment.json"), HasSubstr("\"" + row.at("environment_id") + "\": {"));
    EXPECT_THAT(row.at("pinned"), testing::AnyOf("yes", "no"));
  }
}

TEST_F(Compare, TheColumnsBeginWithTheAgreedOnes) {
  run(small + " -s grid -r primary" + out());
  EXPECT_THAT(
      content(folder_ / "records.csv"),
      testing::StartsWith(
          "scene,scene_hash,structure,spec,batch,rays,hits,ray_hash,reference_hash,hit_hash,build_s,bytes,"
          "peak_bytes,nx,ny,nz,cells,references,steps_per_ray,cell_steps_per_ray,empty_cell_steps_per_ray,"
          "tests_per_ray,mrays_per_s,ratio,ratio_low,ratio_high,right,within_bound,tie,edge,grazing,at_limit,"
          "degenerate,wrong,not_given,unexplained,isa,threads,rounds,note,"));
}

TEST_F(Compare, AKilledRunGoesOnFromItsRecords) {
  const std::string command = small + " -s grid -s octree -r primary -r random" + out();
  ASSERT_EQ(run(command).status, 0);
  const std::string whole = content(folder_ / "records.jsonl");
  // As if the run had been killed while it wrote its fourth record.
  std::size_t at = 0;
  for (int line = 0; line < 3; ++line) at = whole.find('\n', at) + 1;
  std::ofstream(folder_ / "records.jsonl", std::ios::binary) << whole.substr(0, at + 20);
  ASSERT_EQ(run(command).status, 0);
  const std::string again = content(folder_ / "records.jsonl");
  EXPECT_EQ(again.substr(0, at), whole.substr(0, at)) << "finished records were measured again";
  EXPECT_EQ(std::count(again.begin(), again.end(), '\n'), std::count(whole.begin(), whole.end(), '\n'));
  // Other settings are other records.
  ASSERT_EQ(run(command + " --seed 2").status, 0);
  EXPECT_GT(content(folder_ / "records.jsonl").size(), again.size());
}

TEST_F(Compare, AMemoryLimitIsSaidInTheRowAndDoesNotStopTheRun) {
  const Outcome outcome =
      run(small + " -s tunable-grid:cells=256 -s grid -r primary --memory-limit 3MB" + out());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  const auto rows = read_csv(folder_ / "records.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_FALSE(rows[0].at("note").empty());
  EXPECT_EQ(rows[1].at("status"), "ok");
}

TEST_F(Compare, AnOwnStructureThatIsNotBuiltIsStatusOne) {
  const Outcome outcome = run(small + " -s grid -s counted-bvh -r primary --memory-limit 1000" + out());
  EXPECT_EQ(outcome.status, 1) << outcome.text;
  const auto rows = read_csv(folder_ / "records.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("status"), "failed");
  EXPECT_EQ(rows[0].at("right"), "");
}

TEST_F(Compare, SweepsAndBaselines) {
  const Outcome outcome = run(small + " -s grid:amount=0.5,1,2 -r primary --baseline counted-bvh" + out());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  const auto rows = read_csv(folder_ / "records.csv");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_LT(std::stod(rows[0].at("nx")), std::stod(rows[2].at("nx")));
  EXPECT_EQ(rows[3].at("structure"), "counted-bvh");
}

TEST_F(Compare, PicturesOfARun) {
  const Outcome outcome = run(small + " -s grid:amount=1,2 -s embree -r whitted:depth=2 --pictures" + out());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("pictures in " + (folder_ / "pictures").string()));
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "pictures"))
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  EXPECT_THAT(names, testing::UnorderedElementsAre("picture.png", "heat-steps.png", "heat-empty-steps.png",
                                                   "heat-tests.png", "heat-distinct-tests.png", "grid.exr",
                                                   "grid_amount=2.exr", "embree.exr"));
}

TEST_F(Compare, BadUsageIsOneLineAndStatusTwo) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "subcommand"},
      {"compare", "scene"},
      {"compare nosuch", "there are the generated scenes soup"},
      {"compare ./nosuch.nff", "nosuch.nff: no such file"},
      {"compare soup -s nosuch", "no structure 'nosuch'; there are: grid"},
      {"compare soup -s grid:cells=3", "no parameter 'cells'; there are: amount"},
      {"compare soup -s grid:amount=-1", "should be a number"},
      {"compare soup -r nosuch", "nosuch"},
      {"compare soup --size 64", "expected WIDTHxHEIGHT"},
      {"compare soup --size 0x5", "expected WIDTHxHEIGHT"},
      {"compare soup --camera from=1x2x3", "'at' is missing"},
      {"compare soup --rounds 2", "rounds"},
      {"compare soup --pictures", "--pictures needs a folder to write to"},
      {"compare soup --pictures --out /tmp --size 60000x60000", "67108864 pixels are the most"},
      {"compare soup --seed -1", "seed"},
      {"compare /tmp", "/tmp: a folder"},
      {"compare soup:triangles=0", "should be a whole number"},
      {"list nosuch", "nosuch"},
      {"compare soup --out /dev/null/x", "/dev/null/x"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(message)) << arguments;
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, testing::StartsWith("raymeter: "));
  }
}

TEST_F(Compare, OneBadSceneDoesNotStopTheOthers) {
  const Outcome outcome =
      run("compare ./nosuch.ply soup:triangles=100 -s grid -r primary --size 16x16 --rounds 3" + out());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.text, HasSubstr("nosuch.ply"));
  EXPECT_EQ(read_csv(folder_ / "records.csv").size(), 2u);
}

TEST(List, ShowsEverythingWithParameters) {
  EXPECT_THAT(run("list structures").text, HasSubstr("relative subdivision amount"));
  EXPECT_THAT(run("list scenes").text, HasSubstr("soup"));
  EXPECT_THAT(run("list rays").text, HasSubstr("reflection"));
  EXPECT_THAT(run("list columns").text, HasSubstr("empty_cell_steps_per_ray"));
  for (const char* what : {"structures", "scenes", "rays", "columns"}) {
    const Outcome outcome = run(std::string("list ") + what);
    EXPECT_EQ(outcome.status, 0);
    for (const std::string& line : lines_of(outcome.text)) EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST(Help, Teaches) {
  const Outcome outcome = run("compare --help");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.text, HasSubstr("Examples:"));
  EXPECT_THAT(outcome.text, HasSubstr("xit status"));
  for (const std::string& line : lines_of(outcome.text)) EXPECT_LE(line.size(), 100u) << line;
}

}  // namespace
}  // namespace raymeter
