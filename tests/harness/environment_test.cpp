#include "harness/environment.h"

#include <gtest/gtest.h>

#include <set>

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

TEST(Environment, BuildIdIsKnownAndStable) {
  EXPECT_NE(build_id(), 0u);
  EXPECT_EQ(build_id(), build_id());
}

}  // namespace
}  // namespace raymeter
