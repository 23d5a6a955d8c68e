#include "harness/environment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "baselines/embree.h"

namespace raymeter {
namespace {

TEST(Environment, NamesAreUniqueAndValuesAreNotEmpty) {
  std::set<std::string> names;
  for (const auto& [name, value] : environment()) {
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_FALSE(value.empty()) << name;
    EXPECT_EQ(value.find('\n'), std::string::npos) << name;
  }
  for (const char* name : {"cpu", "cpu_features", "compiler", "build_flags", "build_id", "embree", "kernel",
                           "transparent_huge_pages", "load_average", "virtual_machine", "time"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST(Environment, IdIsTheSameInEveryRunOfAProcess) {
  const std::string id = environment_id();
  EXPECT_EQ(id.size(), 16u);
  EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
  EXPECT_EQ(environment_id(), id);
}

TEST(Environment, LibrariesAreThoseThatAreLoaded) {
  const Environment entries = environment();
  EXPECT_THAT(entries, testing::Contains(std::pair<std::string, std::string>("embree", embree_version())));
  EXPECT_THAT(entries, testing::Contains(testing::Pair("tbb", testing::MatchesRegex("[0-9]+\\.[0-9]+.*"))));
}

TEST(Environment, BuildIdIsKnownAndStable) {
  EXPECT_NE(build_id(), 0u);
  EXPECT_EQ(build_id(), build_id());
}

}  // namespace
}  // namespace raymeter
