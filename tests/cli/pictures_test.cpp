#include "cli/pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace raymeter {
namespace {

TEST(Pictures, NamesOfFilesAreReadable) {
  EXPECT_EQ(as_file_name("grid:amount=0.5"), "grid_amount=0.5");
  EXPECT_EQ(as_file_name("two-level-grid:fit=box:threshold=3"), "two-level-grid_fit=box_threshold=3");
  EXPECT_EQ(as_file_name("my_scene.nff"), "my_scene.nff");
}

TEST(Pictures, OtherTextsHaveOtherNames) {
  const std::string longest(120, 'x');
  const std::string texts[] = {longest,   longest + "1", longest + "2", "a:b_c=1",   "a:b:c=1",
                               "a_b_c=1", "a/b",         "a b",         "a\xc3\xa4", "a\xc3\xb6"};
  std::set<std::string> names;
  for (const std::string& text : texts) {
    const std::string name = as_file_name(text);
    EXPECT_THAT(name, testing::MatchesRegex("[A-Za-z0-9._=-]{1,129}"));
    EXPECT_TRUE(name == "a_b_c=1" || names.insert(name).second) << text;
  }
}

}  // namespace
}  // namespace raymeter
