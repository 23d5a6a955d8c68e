#include "scenes/readers/text_cursor.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "scenes/base/error.h"

namespace raymeter {
namespace {

bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// from_chars takes no plus sign.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

/// Whether a well-formed number beyond double's range is too small for it, not too large.
bool is_tiny(std::string_view word) {
  const std::size_t exponent_at = std::min(word.find_first_of("eE"), word.size());
  const std::string_view mantissa = word.substr(0, exponent_at);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t first = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  std::string_view exponent = word.substr(std::min(exponent_at + 1, word.size()));
  long long e = 0;
  const auto read = std::from_chars(without_plus(exponent).data(), exponent.data() + exponent.size(), e);
  if (read.ec == std::errc::result_out_of_range) return exponent[0] == '-';
  return static_cast<long long>(point) - static_cast<long long>(first) + e < 0;
}

}  // namespace

TextCursor::TextCursor(std::string file, std::string_view text, TextDialect dialect)
    : file_(std::move(file)), text_(text), dialect_(dialect) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) position_ = byte_order_mark.size();
}

bool TextCursor::at_line_end() const {
  return position_ < text_.size() && is_line_end(text_[position_]);
}

void TextCursor::skip_line_end() {
  position_ += text_.substr(position_).starts_with("\r\n") ? 2 : 1;
  ++line_;
}

void TextCursor::skip_blanks_on_line() {
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (is_blank(c)) {
      ++position_;
    } else if (c == dialect_.comment && c != '\0') {
      while (position_ < text_.size() && !is_line_end(text_[position_])) ++position_;
      return;
    } else if (dialect_.continuation && c == '\\' && position_ + 1 < text_.size() &&
               is_line_end(text_[position_ + 1])) {
      ++position_;
      skip_line_end();
    } else {
      return;
    }
  }
}

std::string_view TextCursor::word_on_line() {
  skip_blanks_on_line();
  word_line_ = line_;
  const std::size_t begin = position_;
  while (position_ < text_.size()) {
    const char c = text_[position_];
    if (is_blank(c) || is_line_end(c) || (c == dialect_.comment && c != '\0')) break;
    if (dialect_.continuation && c == '\\' && position_ + 1 < text_.size() &&
        is_line_end(text_[position_ + 1]))
      break;
    ++position_;
  }
  return text_.substr(begin, position_ - begin);
}

std::string_view TextCursor::word() {
  for (;;) {
    const std::string_view found = word_on_line();
    if (!found.empty() || !at_line_end()) return found;
    skip_line_end();
  }
}

std::string_view TextCursor::peek() {
  const std::string_view found = word();
  position_ -= found.size();  // a word crosses no line, so the line count stands
  return found;
}

void TextCursor::skip_line() {
  while (!word_on_line().empty()) continue;
  if (at_line_end()) skip_line_end();
}

float TextCursor::to_float(std::string_view word, std::string_view what) const {
  const std::string_view digits = without_plus(word);
  double value = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = !digits.empty() && end == digits.data() + digits.size() &&
                         status != std::errc::invalid_argument &&
                         (is_digit(digits.back()) || digits.back() == '.');
  if (!is_number) fail_expected(what, word);
  if (status == std::errc::result_out_of_range && is_tiny(digits)) return 0;
  // The cast of what lies beyond float's range would be undefined; half an ulp above its maximum is infinity.
  constexpr double too_large = 0x1.ffffffp127;
  if (status == std::errc::result_out_of_range || !(std::abs(value) < too_large))
    fail(fmt::format("{}: {} is beyond the range of float", what, in_quotes(word)));
  return static_cast<float>(value);
}

std::int64_t TextCursor::to_integer(std::string_view word, std::string_view what) const {
  const std::string_view digits = without_plus(word);
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status == std::errc::result_out_of_range && end == digits.data() + digits.size())
    fail(fmt::format("{}: {} is beyond the range of integers", what, in_quotes(word)));
  if (status != std::errc{} || end != digits.data() + digits.size()) fail_expected(what, word);
  return value;
}

Vec3 TextCursor::next_vector(std::string_view what) {
  const float x = next_float(what), y = next_float(what), z = next_float(what);
  return {x, y, z};
}

void TextCursor::fail(std::string_view what) const {
  fail_at(line(), what);
}

void TextCursor::fail_at(std::size_t line, std::string_view what) const {
  throw error_at_line(file_, line, what);
}

void TextCursor::fail_expected(std::string_view what, std::string_view word) const {
  if (!word.empty()) fail(fmt::format("expected {}, found {}", what, in_quotes(word)));
  fail(fmt::format("expected {}, found the end of the {}", what, position_ < text_.size() ? "line" : "file"));
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t limit = 32;
  std::string out = "\"";
  for (const char c : text.substr(0, limit)) {
    if (c >= ' ' && c <= '~')
      out += c;
    else
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  out += text.size() > limit ? fmt::format("...\" ({} characters)", text.size()) : "\"";
  return out;
}

}  // namespace raymeter
