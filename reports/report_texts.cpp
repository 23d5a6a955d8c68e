// The report in Markdown and LaTeX.
#include <fmt/format.h>

#include "reports/report_page.h"
#include "reports/report_tables.h"
#include "reports/verdict.h"

namespace raymeter {
namespace {

std::string heading(const ReportSection& section) {
  return section.title + (section.setting.empty() ? "" : " (" + section.setting + ")");
}

/// The tables of a section that have rows.
std::vector<Table> tables_of(const Report& report, const ReportSection& section) {
  std::vector<Table> tables{build_table(report, section), ratio_table(report, section),
                            work_table(report, section), break_even_table(report, section)};
  for (const Sweep& sweep : structure_sweeps(report, section))
    tables.push_back(sweep_table(report, section, sweep));
  std::erase_if(tables, [](const Table& table) { return table.rows.empty(); });
  return tables;
}

}  // namespace

std::string report_markdown(const Report& report) {
  std::string text = fmt::format("# {}\n\n", markdown_text(question(report)));
  for (const Finding& finding : verdict(report))
    text += fmt::format("- **{}:** {}\n", markdown_text(finding.head), markdown_text(finding.text));
  text += "\n";
  if (report.sections.size() > 1) text += markdown_table(overview_table(report));
  for (const Sweep& sweep : scene_sweeps(report)) text += markdown_table(scene_sweep_table(report, sweep));
  for (const ReportSection& section : report.sections) {
    text += fmt::format("## {}\n\n", markdown_text(heading(section)));
    for (const Table& table : tables_of(report, section)) text += markdown_table(table);
    for (const std::string& remark : remarks(report, section))
      text += fmt::format("- {}\n", markdown_text(remark));
    text += "\n";
  }
  for (const auto& [id, entries] : report.environments) {
    text += fmt::format("## Environment {}\n\n", markdown_text(id));
    for (const auto& [name, value] : entries)
      text += fmt::format("- {}: {}\n", markdown_text(name), markdown_text(value));
    text += "\n";
  }
  return text;
}

std::string report_latex(const Report& report) {
  std::string text =
      "% Tables by Raymeter. In the preamble: \\usepackage{booktabs} \\usepackage[T1]{fontenc}\n\n";
  if (report.sections.size() > 1) text += latex_table(overview_table(report));
  for (const Sweep& sweep : scene_sweeps(report)) text += latex_table(scene_sweep_table(report, sweep));
  for (const ReportSection& section : report.sections)
    for (Table& table : tables_of(report, section)) {
      table.caption = heading(section) + ": " + table.caption;
      text += latex_table(table);
    }
  return text;
}

}  // namespace raymeter
