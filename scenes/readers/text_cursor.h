#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "scenes/geometry/vec3.h"

namespace raymeter {

/// What else a text format has besides words and lines.
struct TextDialect {
  char comment = '\0';        ///< from this character to the end of its line is a comment; 0: none
  bool continuation = false;  ///< a backslash at the end of a line joins the next one to it
};

/// Reads a text file word by word and knows on which line it is. Lines end in LF, CR LF or CR; words are
/// separated by white space. Linear in the length of the text, whatever it holds.
class TextCursor {
 public:
  /// `file` is for messages; `text` must outlive the cursor.
  TextCursor(std::string file, std::string_view text, TextDialect dialect = {});

  /// The next word, on this line or a later one; empty at the end of the text.
  std::string_view word();
  /// The next word of this line; empty at its end.
  std::string_view word_on_line();
  /// What word() will return.
  std::string_view peek();
  /// To the beginning of the next line.
  void skip_line();

  /// The line of the last word (of the end, when there was none), from 1.
  std::size_t line() const { return word_line_; }
  std::size_t offset() const { return position_; }
  std::size_t bytes_left() const { return text_.size() - position_; }

  /// The word as a number, finite and within the range of float: read as double, then rounded to the nearest
  /// float. So a text may differ by one unit in the last place from its nearest float, once in 2^29 numbers,
  /// alike on every machine. nan, inf and what overflows are errors; what underflows is 0.
  /// `what` is what was expected, for the message.
  float to_float(std::string_view word, std::string_view what) const;
  /// The word as a whole number.
  std::int64_t to_integer(std::string_view word, std::string_view what) const;

  float next_float(std::string_view what) { return to_float(word(), what); }
  std::int64_t next_integer(std::string_view what) { return to_integer(word(), what); }
  /// Three numbers, on one line or more.
  Vec3 next_vector(std::string_view what);

  /// Throws an Error that names file and line.
  [[noreturn]] void fail(std::string_view what) const;
  [[noreturn]] void fail_at(std::size_t line, std::string_view what) const;

 private:
  bool at_line_end() const;
  void skip_line_end();
  void skip_blanks_on_line();
  [[noreturn]] void fail_expected(std::string_view what, std::string_view word) const;

  std::string file_;
  std::string_view text_;
  TextDialect dialect_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  std::size_t word_line_ = 1;
};

/// Text of a file made fit for a message: in quotes, short, printable.
std::string in_quotes(std::string_view text);

}  // namespace raymeter
