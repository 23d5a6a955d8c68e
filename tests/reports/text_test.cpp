#include "reports/text.h"

#include <gtest/gtest.h>

namespace raymeter {
namespace {

TEST(Wrapped, LeavesAloneWhatFits) {
  EXPECT_EQ(wrapped("", "", 4), "\n");
  EXPECT_EQ(wrapped("name  : ", "two  words", 4), "name  : two  words\n");
}

TEST(Wrapped, FillsThePageAndIndentsFurtherLines) {
  const std::string filling(page_width - 6, 'x');
  EXPECT_EQ(wrapped("h: ", filling + " ab cd ef", 2), "h: " + filling + " ab\n  cd ef\n");
  EXPECT_EQ(wrapped("h: ", filling + " abc", 2), "h: " + filling + "\n  abc\n");
}

TEST(Wrapped, LetsALongWordStickOut) {
  const std::string word(page_width + 20, 'x');
  EXPECT_EQ(wrapped("h: ", word, 2), "h: " + word + "\n");
  EXPECT_EQ(wrapped("h: ", "a " + word + " b", 2), "h: a\n  " + word + "\n  b\n");
}

}  // namespace
}  // namespace raymeter
