#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raymeter {

/// What a reader must see of a cell beside its text.
enum class Mark : unsigned char { plain, best, noisy, fault };

struct TableCell {
  std::string text;
  Mark mark = Mark::plain;
  std::optional<std::size_t> spec = {};  ///< of a report: lets the page filter columns
};

struct TableColumn {
  std::string title;
  std::string unit = {};
  bool number = true;  ///< aligned right
  std::optional<std::size_t> spec = {};
  std::optional<std::size_t> batch = {};
};

struct TableRow {
  std::vector<TableCell> cells;
  std::optional<std::size_t> spec = {}, batch = {}, section = {};
  bool begins_group = false;  ///< set apart from the row above
};

/// A table, whichever form it is written in.
struct Table {
  std::string caption;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::string note = {};  ///< below it
};

/// GitHub's Markdown. Marks: best is bold, noisy has a ~, a fault is bold.
std::string markdown_table(const Table& table);

/// LaTeX, a tabular with the rules of booktabs in a table environment. Non-ASCII letters stay as they are
/// (UTF-8, as LaTeX expects since 2018).
std::string latex_table(const Table& table);

/// Text with everything that LaTeX would not print as it stands written so that it does.
std::string latex_text(std::string_view text);

/// Text with everything that Markdown or a table of it would understand as markup escaped.
std::string markdown_text(std::string_view text);

}  // namespace raymeter
