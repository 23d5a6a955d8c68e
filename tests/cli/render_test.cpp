// `raymeter render`, end to end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "run_command.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
using testing::Not;

class Render : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("render_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }
  std::string bytes(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::ptrdiff_t files() const {
    return std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator());
  }

  std::filesystem::path folder_;
};

const std::string small = "render soup:triangles=500:size=0.2 --size 64x48 ";

TEST_F(Render, WritesThePictureAndPrintsItsRays) {
  const Outcome outcome = run(small + "-o " + in_folder("a.png"));
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("64x48, depth 5, ray hash "));
  EXPECT_THAT(outcome.text, HasSubstr("  primary         1         3072 "));
  EXPECT_THAT(outcome.text, HasSubstr("counted-bvh:branching=8: built in "));
  EXPECT_THAT(outcome.text, HasSubstr(" references, "));
  EXPECT_THAT(outcome.text, HasSubstr(" steps, "));
  EXPECT_THAT(outcome.text, Not(HasSubstr("\r")));
  EXPECT_THAT(bytes("a.png"), testing::StartsWith("\x89PNG"));
  EXPECT_EQ(files(), 1);
}

TEST_F(Render, EveryStructureMakesTheSamePicture) {
  for (const char* spec : {"embree", "grid", "octree:traversal=top-down"}) {
    const std::string name = std::string(spec).substr(0, 4) + ".exr";
    EXPECT_EQ(run(small + "--depth 2 -s " + spec + " -o " + in_folder(name)).status, 0);
    EXPECT_GT(bytes(name).size(), 3000u);
  }
  // Embree can't count: its file has no layers of counts.
  EXPECT_THAT(bytes("embr.exr"), Not(HasSubstr("distinct_tests")));
  EXPECT_THAT(bytes("grid.exr"), HasSubstr("distinct_tests"));
}

TEST_F(Render, HeatMapsOfSeveralStructures) {
  const Outcome outcome = run(small + "-s grid --compare octree --compare two-level-grid --heat tests -o " +
                              in_folder("heat.png"));
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("\noctree:"));
  EXPECT_THAT(outcome.text, HasSubstr("\ntwo-level-grid:"));
  EXPECT_THAT(bytes("heat.png"), testing::StartsWith("\x89PNG"));
}

TEST_F(Render, SeveralHeatMapsAreRows) {
  const Outcome outcome =
      run(small + "-s grid --compare octree --heat steps --heat tests -o " + in_folder("rows.png"));
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(bytes("rows.png"), testing::StartsWith("\x89PNG"));
}

/// Starts the command, interrupts it when `now` says so, and returns how it ended.
template <class Now>
int interrupted(std::vector<std::string> arguments, const Now& now) {
  arguments.insert(arguments.begin(), RAYMETER_COMMAND);
  const pid_t child = fork();
  if (child == 0) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  while (!now()) {
    if (waitpid(child, &status, WNOHANG) != 0) return status;  // too late
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGINT);
  waitpid(child, &status, 0);
  return status;
}

TEST_F(Render, InterruptedItLeavesNoHalfWrittenFile) {
  const std::vector<std::string> command{"render", "soup:triangles=500", "--depth", "1",
                                         "-o",     in_folder("a.exr"),   "--size",  "1500x1500"};
  // While it renders, for seconds: after a quarter of one.
  const auto start = std::chrono::steady_clock::now();
  const int rendering = interrupted(
      command, [&] { return std::chrono::steady_clock::now() - start > std::chrono::milliseconds(250); });
  EXPECT_TRUE(WIFSIGNALED(rendering) && WTERMSIG(rendering) == SIGINT) << rendering;
  EXPECT_EQ(files(), 0);
  // While it writes: when the file under its provisional name has grown. An older picture stays as it was.
  std::ofstream(folder_ / "a.exr") << "older";
  const int writing = interrupted(command, [&] {
    std::error_code gone;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      if (entry.path().filename() != "a.exr" && entry.file_size(gone) > 10000 && !gone) return true;
    return false;
  });
  EXPECT_TRUE(WIFSIGNALED(writing) && WTERMSIG(writing) == SIGINT) << writing;
  EXPECT_EQ(files(), 1);
  EXPECT_EQ(bytes("a.exr"), "older");
}

TEST_F(Render, WithoutAFileItOnlyCounts) {
  const Outcome outcome = run(small + "--pixels corners --rays primary");
  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("65x49"));
  EXPECT_THAT(outcome.text, HasSubstr("per primary ray: "));
}

TEST_F(Render, RefusesInOneLineAndWritesNothing) {
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.text, HasSubstr(why));
    EXPECT_EQ(lines_of(outcome.text).size(), 1u) << outcome.text;
  };
  refused(small + "-o " + in_folder("a.jpg"), "a picture's name ends in .png or .exr");
  refused(small + "-o " + in_folder("none/a.png"), "there is no folder");
  refused(small + "--heat tests", "--heat needs a file");
  refused(small + "--heat stairs -o " + in_folder("a.png"), "no heat map 'stairs'");
  refused(small + "--heat tests -o " + in_folder("a.exr"), "--heat makes a PNG");
  refused(small + "--compare grid -o " + in_folder("a.png"), "--compare lays heat maps");
  refused(small + "-s embree --heat tests -o " + in_folder("a.png"), "embree can't count");
  refused(small + "-s griid", "griid");
  refused("render soup --size 60000x60000 -o " + in_folder("a.png"), "67108864 pixels are the most");
  refused("render soup --size 0x5", "--size 0x5");
  refused(small + "--depth 65", "--depth");
  const std::string hostile = std::string(RAYMETER_SHARED_DATA) + "/hostile/n14_resolution_huge.nff";
  if (std::filesystem::exists(hostile)) {
    refused("render " + hostile + " -o " + in_folder("a.png"), "1000000x1000000 pixels is too large");
    EXPECT_EQ(files(), 0);
    EXPECT_EQ(run("render " + hostile + " --size 8x8 -o " + in_folder("a.png")).status, 0);
    EXPECT_EQ(files(), 1);
  }
}

}  // namespace
}  // namespace raymeter
