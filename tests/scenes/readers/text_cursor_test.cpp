#include "scenes/readers/text_cursor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

std::string complaint(const std::string& word) {
  const TextCursor cursor("file", "");
  try {
    cursor.to_float(word, "a number");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

float number(const std::string& word) {
  return TextCursor("file", "").to_float(word, "a number");
}

TEST(TextCursor, counts_lines_of_every_kind) {
  TextCursor cursor("file", "a b\nc\r\nd\r\n\r\ne\rf");
  for (const auto& [word, line] : {std::pair("a", 1u), std::pair("b", 1u), std::pair("c", 2u),
                                   std::pair("d", 3u), std::pair("e", 5u), std::pair("f", 6u)}) {
    EXPECT_EQ(cursor.peek(), word);
    EXPECT_EQ(cursor.word(), word);
    EXPECT_EQ(cursor.line(), line);
  }
  EXPECT_EQ(cursor.word(), "");
}

TEST(TextCursor, comments_and_continuations) {
  TextCursor cursor("file", "# all\na#b\nc\\\n d \\\r\n e#f\\\ng\\h", {.comment = '#', .continuation = true});
  EXPECT_EQ(cursor.word(), "a");
  EXPECT_EQ(cursor.word_on_line(), "");
  EXPECT_EQ(cursor.word(), "c");
  EXPECT_EQ(cursor.word_on_line(), "d");
  EXPECT_EQ(cursor.word_on_line(), "e");
  EXPECT_EQ(cursor.line(), 5u);
  EXPECT_EQ(cursor.word_on_line(), "");
  EXPECT_EQ(cursor.word(), "g\\h");
}

TEST(TextCursor, numbers) {
  EXPECT_EQ(number("1"), 1.0f);
  EXPECT_EQ(number("+.5e+1"), 5.0f);
  EXPECT_EQ(number("-5."), -5.0f);
  EXPECT_EQ(number("0.1"), 0.1f);
  EXPECT_EQ(number("3.4028235e38"), std::numeric_limits<float>::max());
  EXPECT_EQ(number("1e-999"), 0.0f);
  EXPECT_EQ(number("-0." + std::string(500, '0') + "1e50"), 0.0f);
  EXPECT_EQ(number(std::string(1000000, '0') + "1"), 1.0f);
  EXPECT_EQ(number("1." + std::string(1000000, '3')), 4.0f / 3);
  for (const char* word :
       {"", "x", "nan", "inf", "-inf", "infinity", "1x", "1e", "0x10", "+-1", "++1", "-", ".", "1,5"})
    EXPECT_THAT(complaint(word), testing::StartsWith("file:1: expected a number, found ")) << word;
  for (const std::string& word : {std::string("1e39"), std::string("-3.4028236e38"), std::string("1e999"),
                                  std::string("1e99999999999999999999"), std::string(400, '9') + "e-1"})
    EXPECT_THAT(complaint(word), testing::HasSubstr("beyond the range of float")) << word;
}

TEST(TextCursor, words_are_fit_to_be_printed) {
  EXPECT_EQ(in_quotes("a\nb\xff"), "\"a\\x0ab\\xff\"");
  EXPECT_LT(in_quotes(std::string(1000000, 'x')).size(), 100u);
}

}  // namespace
}  // namespace raymeter
