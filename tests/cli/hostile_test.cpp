// Malformed and hostile scenes, through the command: a table, a row a file. What must be read is read, with
// so many primitives and the same hits in every structure; what must be refused is refused in one line that
// says where; within 20 s of CPU time and 1 GB, whatever the file claims.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <functional>
#include <optional>

#include "tests/cli/hostile_rows.h"
#include "tests/cli/run_command.h"
#include "tests/cli/run_limited.h"

namespace raymeter {
namespace {

namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__)  // several times slower and larger
constexpr std::uint64_t most_bytes = 4'000'000'000;
constexpr Limits limits{.cpu_seconds = 100, .wall_seconds = 280};
// One of each kind of code.
constexpr const char* structures[] = {"grid", "octree", "two-level-grid", "brick-grid", "embree"};
#else
constexpr std::uint64_t most_bytes = 1'000'000'000;
constexpr Limits limits;
constexpr const char* structures[] = {"grid",       "tunable-grid", "octree",     "two-level-grid",
                                      "brick-grid", "embree",       "counted-bvh"};
#endif

const fs::path project_folder = fs::path(RAYMETER_TEST_DATA) / "hostile";
const fs::path shared_folder = fs::path(RAYMETER_SHARED_DATA) / "hostile";

/// A folder of this test's own, gone with it; rows that make their file make it there.
class HostileFile : public testing::TestWithParam<HostileRow> {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / fmt::format("hostile_{}_{}", getpid(), GetParam().file);
    fs::create_directories(folder_);
    path_ = project_folder / GetParam().file;
    if (!GetParam().make) return;
    path_ = folder_ / GetParam().file;
    GetParam().make(path_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static void expect_within_limits(const LimitedRun& run) {
    EXPECT_EQ(run.signal, 0) << "killed by a limit, or crashed\n" << run.text;
    EXPECT_LT(run.peak_bytes, most_bytes);
  }

  void expect_refused() const {
    const LimitedRun run = run_limited({"compare", path_.string(), "-s", "grid"}, limits);
    expect_within_limits(run);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(lines_of(run.text).size(), 1u) << run.text;
    EXPECT_LT(run.text.size(), path_.string().size() + 400);
    EXPECT_THAT(run.text, testing::StartsWith("raymeter: " + path_.string() + ":"));
    EXPECT_THAT(run.text.substr(std::min(run.text.size(), 10 + path_.string().size())),
                testing::ContainsRegex(std::string("^: ?") + GetParam().refused));
    EXPECT_THAT(run.text, testing::Not(testing::HasSubstr("ERROR"))) << "a sanitizer's report";
  }

  void expect_read(const std::string& structure) const {
    SCOPED_TRACE(structure);
    const HostileRow& expected = GetParam();
    std::vector<std::string> command{"compare",
                                     path_.string(),
                                     "-s",
                                     structure,
                                     "--baseline",
                                     "brute-force",
                                     "--size",
                                     "16x16",
                                     "-r",
                                     "primary",
                                     "-r",
                                     "random:count=256",
                                     "--rounds",
                                     "3",
                                     "--time-budget",
                                     "0.01",
                                     "--out",
                                     (folder_ / structure).string()};
    if (expected.camera) command.insert(command.end(), {"--camera", expected.camera});
    const LimitedRun run = run_limited(command, limits);
    expect_within_limits(run);
    EXPECT_EQ(run.status, 0) << run.text;
    const auto rows = read_csv(folder_ / structure / "records.csv");
    ASSERT_EQ(rows.size(), 4u) << run.text;
    for (const CsvRow& row : rows) {
      SCOPED_TRACE(row.at("spec") + " " + row.at("batch"));
      EXPECT_EQ(row.at("primitives"), std::to_string(expected.primitives));
      const bool is_embree = row.at("structure") == "embree";
      if (is_embree && expected.embree_refuses) {
        EXPECT_EQ(row.at("status"), "failed");
        EXPECT_THAT(row.at("note"), testing::HasSubstr(expected.embree_refuses));
        continue;
      }
      EXPECT_EQ(row.at("status"), "ok");
      EXPECT_EQ(row.at("hits"),
                std::to_string(row.at("batch") == "primary" ? expected.primary_hits : expected.random_hits));
      EXPECT_EQ(row.at("wrong") + row.at("not_given") + row.at("unexplained"), "000");
      if (is_embree) continue;
      EXPECT_EQ(row.at("hit_hash"), row.at("reference_hash"));
      EXPECT_EQ(row.at("brute_forced"), row.at("rays"));
    }
  }

  fs::path folder_, path_;
};

TEST_P(HostileFile, IsReadOrRefusedAsItShould) {
  const HostileRow& row = GetParam();
  if (row.unreadable && access(path_.c_str(), R_OK) == 0) GTEST_SKIP() << "root reads everything";
  if (row.refused)
    expect_refused();
  else
    for (const char* structure : structures) expect_read(structure);
}

INSTANTIATE_TEST_SUITE_P(All, HostileFile, testing::ValuesIn(hostile_rows()), [](const auto& row) {
  std::string name = row.param.file;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST(HostileFiles, AllHaveARow) {
  const auto rows = hostile_rows();
  for (const fs::path& folder : {project_folder, shared_folder}) {
    if (!fs::exists(folder)) continue;
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename();
      if (name == "README.md") continue;
      ++count;
      EXPECT_EQ(std::ranges::count(rows, name, &HostileRow::file), 1) << entry.path();
    }
    EXPECT_GE(count, 36u) << folder;
  }
}

TEST(HostileFiles, AreTheSharedOnes) {
  if (!fs::exists(shared_folder)) GTEST_SKIP() << "no shared data";
  const fs::path made = fs::path(testing::TempDir()) / fmt::format("hostile_{}_made", getpid());
  for (const HostileRow& row : hostile_rows()) {
    if (!fs::exists(shared_folder / row.file)) continue;
    if (row.make) row.make(made);
    EXPECT_TRUE(content(row.make ? made : project_folder / row.file) == content(shared_folder / row.file))
        << row.file;
    fs::remove(made);
  }
}

}  // namespace
}  // namespace raymeter
