#include "reports/table.h"

#include <fmt/format.h>

namespace raymeter {
namespace {

template <class Escape>
std::string header(const TableColumn& column, const Escape& escape) {
  return column.unit.empty() ? escape(column.title)
                             : fmt::format("{} ({})", escape(column.title), escape(column.unit));
}

}  // namespace

std::string markdown_text(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      result += ' ';
      continue;
    }
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else {
      if (std::string_view("\\`*_[]|#~").find(c) != std::string_view::npos) result += '\\';
      result += c;
    }
  }
  return result;
}

std::string latex_text(std::string_view text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '\\':
        result += "\\textbackslash{}";
        break;
      case '~':
        result += "\\textasciitilde{}";
        break;
      case '^':
        result += "\\textasciicircum{}";
        break;
      case '<':
        result += "\\textless{}";
        break;
      case '>':
        result += "\\textgreater{}";
        break;
      case '|':
        result += "\\textbar{}";
        break;
      case '"':
        result += "\\textquotedbl{}";
        break;
      case '-':
        result += "{-}";
        break;  // no dashes of two or three
      case '\n':
      case '\r':
        result += ' ';
        break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}':
        result += '\\';
        [[fallthrough]];
      default:
        result += c;
    }
  return result;
}

std::string markdown_table(const Table& table) {
  std::string text = fmt::format("**{}**\n\n|", markdown_text(table.caption));
  for (const TableColumn& column : table.columns) text += fmt::format(" {} |", header(column, markdown_text));
  text += "\n|";
  for (const TableColumn& column : table.columns) text += column.number ? "---:|" : "---|";
  text += '\n';
  for (const TableRow& row : table.rows) {
    text += '|';
    for (const TableCell& cell : row.cells) {
      const std::string shown = markdown_text(cell.text);
      const bool bold = !shown.empty() && (cell.mark == Mark::best || cell.mark == Mark::fault);
      text += fmt::format(" {} |", bold                       ? "**" + shown + "**"
                                   : cell.mark == Mark::noisy ? shown + " \\~"
                                                              : shown);
    }
    text += '\n';
  }
  if (!table.note.empty()) text += "\n" + markdown_text(table.note) + "\n";
  return text + "\n";
}

std::string latex_table(const Table& table) {
  std::string text = fmt::format("\\begin{{table}}\n  \\centering\n  \\caption{{{}}}\n  \\begin{{tabular}}{{",
                                 latex_text(table.caption));
  for (const TableColumn& column : table.columns) text += column.number ? 'r' : 'l';
  text += "}\n    \\toprule\n    ";
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    text += (i ? " & " : "") + header(table.columns[i], latex_text);
  text += " \\\\\n    \\midrule\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const TableRow& row = table.rows[r];
    if (row.begins_group && r) text += "    \\addlinespace\n";
    text += "    ";
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const TableCell& cell = row.cells[i];
      const std::string shown = latex_text(cell.text);
      const bool bold = !shown.empty() && (cell.mark == Mark::best || cell.mark == Mark::fault);
      text += (i ? " & " : "") + (bold                       ? "\\textbf{" + shown + "}"
                                  : cell.mark == Mark::noisy ? shown + "\\rlap{\\textasciitilde}"
                                                             : shown);
    }
    text += " \\\\\n";
  }
  text += "    \\bottomrule\n  \\end{tabular}\n";
  if (!table.note.empty())
    text += fmt::format("  \\par\\smallskip\\footnotesize {}\n", latex_text(table.note));
  return text + "\\end{table}\n\n";
}

}  // namespace raymeter
