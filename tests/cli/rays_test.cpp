// Ray files, through the command.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>

#include "run_command.h"

namespace raymeter {
namespace {

using testing::HasSubstr;

class Rays : public testing::Test {
 protected:
  Rays() : folder_(std::filesystem::path(testing::TempDir()) / ("rays_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~Rays() override { std::filesystem::remove_all(folder_); }
  std::string at(const char* name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

const std::string scene = "soup:triangles=2000";
const std::string batches = " --size 40x30 --seed 7 --camera from=3x2x1:at=0.5x0.5x0.5";
const std::string race = " -s grid -s octree --baseline grid --rounds 3 --time-budget 0.01";

TEST_F(Rays, FromAFileAreThoseMadeDirectly) {
  std::string kinds, files;
  for (const char* kind :
       {"primary", "shadow", "ao:length=0.2", "random:count=300", "whitted:depth=2:rays=shadow-2"}) {
    const std::string file = at((std::string(kind, 2) + ".rays").c_str());
    const Outcome written = run(fmt::format("rays {}{} -r {} -o {}", scene, batches, kind, file));
    EXPECT_EQ(written.status, 0) << written.text;
    EXPECT_THAT(written.text, HasSubstr("rays, " + std::string(kind)));
    kinds.append(" -r ").append(kind);
    files.append(" --ray-file ").append(file);
  }
  const Outcome direct = run("compare " + scene + batches + race + kinds + " --out " + at("direct"));
  const Outcome from_files = run("compare " + scene + race + files + " --out " + at("files"));
  EXPECT_EQ(direct.status, 0) << direct.text;
  EXPECT_EQ(from_files.status, 0) << from_files.text;
  EXPECT_THAT(from_files.text, HasSubstr("\nao:length=0.2:samples=1 from ao.rays: "));

  const auto expected = read_csv(folder_ / "direct/records.csv"),
             rows = read_csv(folder_ / "files/records.csv");
  ASSERT_EQ(expected.size(), 10u);
  ASSERT_EQ(rows.size(), 10u) << "other rays were traced too";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(rows[i].at("spec") + " " + rows[i].at("batch"));
    EXPECT_THAT(rows[i].at("batch"), testing::StartsWith(expected[i].at("batch") + " from "));
    EXPECT_GT(std::stod(rows[i].at("hits")), 0);
    for (const char* same : {"rays", "hits", "ray_hash", "hit_hash", "query", "order", "tests_per_ray"})
      EXPECT_EQ(rows[i].at(same), expected[i].at(same)) << same;
    EXPECT_EQ(rows[i].at("right"), rows[i].at("rays"));
    EXPECT_EQ(rows[i].at("seed"), "");
  }
}

TEST_F(Rays, StandBesideKindsThatAreAskedFor) {
  ASSERT_EQ(run("rays " + scene + batches + " -o " + at("a.rays")).status, 0);
  const Outcome outcome = run("compare " + scene + race + " --size 16x16 -r primary --ray-file " +
                              at("a.rays") + " --out " + at("out"));
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  const auto rows = read_csv(folder_ / "out/records.csv");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].at("batch"), "primary");
  EXPECT_EQ(rows[1].at("batch"), "primary from a.rays");
  EXPECT_EQ(rows[1].at("rays"), "1200");
}

TEST_F(Rays, BadUsageIsOneLineAndStatusTwo) {
  ASSERT_EQ(run("rays " + scene + batches + " -o " + at("a.rays")).status, 0);
  std::ofstream(folder_ / "bad.rays", std::ios::binary) << content(folder_ / "a.rays").substr(0, 1000);
  const std::vector<std::pair<std::string, std::string>> cases{
      {"rays", "scene"},
      {"rays soup", "--output"},
      {"rays nosuch -o " + at("x"), "no scene 'nosuch'"},
      {"rays soup -r nosuch -o " + at("x"), "no rays 'nosuch'"},
      {"rays soup -r ao:length=1,2 -o " + at("x"), "ao:length=1,2"},
      {"rays soup -r whitted:depth=2 --size 8x8 -o " + at("x"),
       "4 batches, and a file holds one; add rays= and one of: primary, shadow-1"},
      {"rays soup:triangles=9 -o " + at("no/x"), "can't be written"},
      {"rays soup:triangles=9 -o /dev/null", "can't be written"},
      {"compare " + scene + " --ray-file " + at("none.rays"), "none.rays: no such file"},
      {"compare " + scene + " --ray-file " + at("bad.rays"), "bad.rays: cut short"},
      {"compare " + scene + ":seed=2 --ray-file " + at("a.rays"), "made for the scene soup:"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments << "\n" << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(message)) << arguments;
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << outcome.text;
    EXPECT_THAT(outcome.text, testing::StartsWith("raymeter: "));
  }
  EXPECT_FALSE(std::filesystem::exists(at("x")));
}

}  // namespace
}  // namespace raymeter
