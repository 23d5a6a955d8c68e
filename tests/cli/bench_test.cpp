// raymeter_bench, end to end: exit status, names, counters, what Google Benchmark's flags do. Nothing about
// times but that there are any.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_command.h"

namespace raymeter {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

const std::string scene = "soup:triangles=500:size=0.05:seed=1";
const std::string small = scene + " --size 32x24 --benchmark_min_time=0.001";

class Bench : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("bench_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Outcome bench(const std::string& arguments) { return run(arguments, RAYMETER_BENCH); }

  /// The benchmarks of a run, by name.
  std::map<std::string, json> results(const std::string& arguments, int status = 0) {
    const fs::path file = folder_ / "out.json";
    const Outcome outcome =
        bench(arguments + " --benchmark_out_format=json --benchmark_out=" + file.string());
    EXPECT_EQ(outcome.status, status) << outcome.text;
    const json report = json::parse(content(file), nullptr, false);
    EXPECT_FALSE(report.is_discarded()) << content(file);
    std::map<std::string, json> all;
    if (report.is_discarded()) return all;
    for (const json& one : report.at("benchmarks"))
      all[one.at("name").get<std::string>().substr(scene.size() + 1)] = one;
    return all;
  }

  fs::path folder_;
};

std::vector<std::string> names_of(const std::map<std::string, json>& results) {
  std::vector<std::string> names;
  for (const auto& [name, result] : results) names.push_back(name);
  return names;
}

TEST_F(Bench, BuildsAndTracesWhatCompareDoes) {
  const std::string selection = " -s grid:amount=0.5,1 -s embree -r primary -r shadow ";
  const auto all = results(small + selection);
  EXPECT_THAT(names_of(all),
              ElementsAre("build/embree/process_time", "build/grid/process_time",
                          "build/grid:amount=0.5/process_time", "primary/embree/trace", "primary/grid/trace",
                          "primary/grid:amount=0.5/trace", "shadow/embree/trace", "shadow/grid/trace",
                          "shadow/grid:amount=0.5/trace"));
  for (const auto& [name, result] : all) {
    EXPECT_FALSE(result.contains("error_occurred")) << name;
    EXPECT_EQ(result.at("primitives"), 500) << name;
    EXPECT_GT(result.at("cpu_time"), 0) << name;
  }
  EXPECT_GT(all.at("build/grid/process_time").at("bytes"), 0);
  EXPECT_EQ(all.at("primary/grid/trace").at("rays"), 32 * 24);
  EXPECT_GT(all.at("primary/grid/trace").at("rays/s"), 0);
  EXPECT_FALSE(all.at("primary/embree/trace").contains("tests_per_ray")) << "it can't be counted in";

  ASSERT_EQ(
      run("compare " + scene + " --size 32x24 --rounds 3" + selection + "--out " + folder_.string()).status,
      0);
  const auto rows = read_csv(folder_ / "records.csv");
  ASSERT_EQ(rows.size(), 6u);
  for (const CsvRow& row : rows) {
    const bool half = row.at("spec").starts_with("grid:amount=0.5:");
    const std::string spec = half ? "grid:amount=0.5" : row.at("structure");
    const json& result = all.at(row.at("batch") + "/" + spec + "/trace");
    for (const char* column : {"rays", "hits", "steps_per_ray", "tests_per_ray"})
      if (!row.at(column).empty()) {
        EXPECT_DOUBLE_EQ(result.at(column).get<double>(), std::stod(row.at(column))) << spec << column;
      }
    if (row.at("batch") == "primary") {
      EXPECT_EQ(all.at("build/" + spec + "/process_time").at("bytes"), std::stod(row.at("bytes"))) << spec;
    }
  }
}

TEST_F(Bench, DefaultsAreThoseOfCompare) {
  const Outcome outcome = bench(small + " --benchmark_list_tests=true");
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  const auto names = lines_of(outcome.text);
  EXPECT_EQ(names.size(), 7u * 5u);
  for (const std::string& name : names) EXPECT_THAT(name, testing::StartsWith(scene + "/"));
  EXPECT_THAT(names, testing::Contains(scene + "/diffuse/two-level-grid/trace"));
  EXPECT_THAT(names, testing::Each(testing::Not(HasSubstr("brute-force"))));
}

TEST_F(Bench, AFilterSelects) {
  EXPECT_THAT(names_of(results(small + " '--benchmark_filter=primary/(octree|grid)/'")),
              ElementsAre("primary/grid/trace", "primary/octree/trace"));
  const Outcome nothing = bench(small + " --benchmark_filter=nosuch");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_EQ(lines_of(nothing.text).size(), 1u) << nothing.text;
}

TEST_F(Bench, StandardOutputIsTheReportAlone) {
  const Outcome outcome = run(
      "-c '" RAYMETER_BENCH " " + small + " -s grid -r primary --benchmark_format=json 2>/dev/null'", "sh");
  const json report = json::parse(outcome.text, nullptr, false);
  ASSERT_FALSE(report.is_discarded()) << outcome.text;
  EXPECT_EQ(report.at("benchmarks").size(), 2u);
  EXPECT_EQ(report.at("context").at("scene_hash of " + scene).get<std::string>().size(), 16u);
  EXPECT_THAT(report.at("context").at("build_flags").get<std::string>(), HasSubstr("-ffp-contract=off"));
}

TEST_F(Bench, SeveralThreadsAreTimedByTheWall) {
  EXPECT_THAT(names_of(results(small + " -s grid -r primary --threads 2")),
              ElementsAre("build/grid/real_time", "primary/grid/trace/real_time"));
}

TEST_F(Bench, AWholeRenderingIsOneBenchmark) {
  const auto all = results(small + " -s grid -s embree -r whitted");
  ASSERT_EQ(all.size(), 4u);
  const json& grid = all.at("whitted/grid/trace");
  EXPECT_GT(grid.at("rays"), 32 * 24) << "more than its primary rays";
  EXPECT_EQ(all.at("whitted/embree/trace").at("hits"), grid.at("hits"));
}

TEST_F(Bench, RaysOfAFile) {
  const std::string file = (folder_ / "some.rays").string();
  ASSERT_EQ(run("rays " + scene + " --size 32x24 -r diffuse -o " + file).status, 0);
  const auto all = results(small + " -s grid -r diffuse --ray-file " + file);
  EXPECT_EQ(all.at("some.rays/grid/trace").at("tests_per_ray"),
            all.at("diffuse/grid/trace").at("tests_per_ray"));
}

TEST_F(Bench, RepetitionsInRandomOrder) {
  const fs::path file = folder_ / "out.json";
  const Outcome outcome = bench(small +
                                " -s grid -s octree -r primary -r shadow --benchmark_repetitions=3"
                                " --benchmark_enable_random_interleaving=true --benchmark_out=" +
                                file.string());
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  const json report = json::parse(content(file));
  int runs = 0;
  for (const json& one : report.at("benchmarks")) {
    EXPECT_FALSE(one.contains("error_occurred")) << one;
    runs += one.at("run_type") == "iteration";
  }
  EXPECT_EQ(runs, 6 * 3);
}

TEST_F(Bench, StructuresOfPlugins) {
  const std::string plugins = RAYMETER_TEST_PLUGINS "/";
  const auto good = results(small + " -s good -r primary --plugin " + plugins + "good.so");
  EXPECT_EQ(good.at("primary/good/trace").at("tests_per_ray"), 500);

  const auto wrong = results(small + " -s wrong -r primary --plugin " + plugins + "wrong.so", 1);
  const json& result = wrong.at("primary/wrong/trace");
  EXPECT_TRUE(result.at("error_occurred").get<bool>());
  EXPECT_THAT(result.at("error_message").get<std::string>(), HasSubstr("answers wrong"));
}

TEST_F(Bench, WhatCanNotBeBuiltIsAnErrorAndDoesNotStopTheOthers) {
  const auto all = results(small + " -s octree -s brute-force -r primary --memory-limit 1000", 1);
  for (const char* name : {"build/octree/process_time", "primary/octree/trace"})
    EXPECT_THAT(all.at(name).at("error_message").get<std::string>(), HasSubstr("allowed")) << name;
  EXPECT_FALSE(all.at("primary/brute-force/trace").contains("error_occurred"));
}

TEST_F(Bench, ABatchWithoutRaysIsSaidToBeOne) {
  const auto all = results(small + " -s grid -r shadow --camera from=5x5x5:at=9x9x9", 0);
  EXPECT_EQ(all.at("shadow/grid/trace").at("error_message"), "no rays");
}

TEST_F(Bench, BadUsageIsOneLineAndStatusTwo) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "scene"},
      {"nosuch", "there are the generated scenes"},
      {"./nosuch.nff", "nosuch.nff: no such file"},
      {"soup -s nosuch", "no structure 'nosuch'; there are: grid"},
      {"soup -s grid:cells=3", "no parameter 'cells'"},
      {"soup -r nosuch", "nosuch"},
      {"soup --size 64", "expected WIDTHxHEIGHT"},
      {"soup --nosuch", "--nosuch"},
      {"soup --benchmark_nosuch=1", "--benchmark_nosuch=1: no such flag"},
      {"soup --benchmark_format=xml", "bad value of a --benchmark flag"},
      {"soup --plugin ./nosuch.so", "no such plug-in"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = bench(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(message)) << arguments;
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, testing::StartsWith("raymeter_bench: "));
  }
}

TEST_F(Bench, HelpTeaches) {
  const Outcome outcome = bench("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* word : {"SCENE/RAYS/STRUCTURE/trace", "--benchmark_filter", "Examples:", "Exit status"})
    EXPECT_THAT(outcome.text, HasSubstr(word));
  for (const std::string& line : lines_of(outcome.text))
    if (!line.starts_with("Usage:")) {
      EXPECT_LE(line.size(), 100u) << line;
    }
}

}  // namespace
}  // namespace raymeter
