#include "reports/report_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "reports/html/page_template.h"
#include "reports/html_text.h"
#include "reports/record_text.h"
#include "reports/report_json.h"
#include "reports/report_tables.h"
#include "reports/verdict.h"
#include "scenes/base/version.h"

namespace raymeter {
namespace {

std::string attribute(const char* name, const std::optional<std::size_t>& value) {
  return value ? fmt::format(" data-{}=\"{}\"", name, *value) : "";
}

std::string swatch(const Report& report, std::size_t spec) {
  return fmt::format("<i class=\"swatch c{}\"></i>", report.specs[spec].colour);
}

std::string html_cell(const TableCell& cell, const TableColumn& column, const std::string& before) {
  constexpr const char* classes[] = {"", " best", " noisy", " fault"};
  return fmt::format("<td class=\"{}{}\"{}{}>{}{}</td>", column.number ? "n" : "t",
                     classes[static_cast<std::size_t>(cell.mark)], attribute("spec", cell.spec),
                     attribute("batch", column.batch), before, html_text(cell.text));
}

/// Text whose lines may break after a colon, as those of specs.
std::string breakable(std::string text) {
  for (std::size_t at = 0; (at = text.find(':', at)) != std::string::npos; at += 6)
    text.insert(at + 1, "<wbr>");
  return text;
}

std::string html_table(const Report& report, const Table& table) {
  std::string text =
      fmt::format("<div class=\"scroll\"><table><caption>{}</caption><thead><tr>", html_text(table.caption));
  for (const TableColumn& column : table.columns) {
    text += fmt::format("<th scope=\"col\" class=\"{}\"{}{}>{}", column.number ? "n" : "t",
                        attribute("spec", column.spec), attribute("batch", column.batch),
                        breakable(html_text(column.title)));
    if (!column.unit.empty()) text += fmt::format(" <span class=\"unit\">{}</span>", html_text(column.unit));
    text += "</th>";
  }
  text += "</tr></thead><tbody>\n";
  for (const TableRow& row : table.rows) {
    text +=
        fmt::format("<tr{}{}{}{}>", row.begins_group ? " class=\"group\"" : "", attribute("spec", row.spec),
                    attribute("batch", row.batch), attribute("section", row.section));
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const bool names_spec = row.spec && row.cells[i].text == report.specs[*row.spec].label;
      text += html_cell(row.cells[i], table.columns[i], names_spec ? swatch(report, *row.spec) : "");
    }
    text += "</tr>\n";
  }
  text += "</tbody></table></div>";
  if (!table.note.empty()) text += fmt::format("<p class=\"note\">{}</p>", html_text(table.note));
  return text;
}

/// A place where a script draws, and the numbers that it draws.
std::string figure(const Report& report, const char* chart, std::size_t section, const std::string& title,
                   const std::string& unit, const Table& table, std::size_t index = 0, bool open = false) {
  if (table.rows.empty()) return "";
  return fmt::format(
      "<figure data-chart=\"{}\" data-of=\"{}\" data-index=\"{}\"><figcaption><h3>{}</h3><span "
      "class=\"unit\">{}</span>"
      "</figcaption><div class=\"panels\"></div><details{}><summary>Numbers</summary>{}</details></figure>\n",
      chart, section, index, html_text(title), html_text(unit), open ? " open" : "",
      html_table(report, table));
}

/// The picture of the scene beside its heading; heat maps below each other.
std::string pictures_html(const ReportSection& section, bool of_heading) {
  std::string text;
  for (std::size_t i = 0; i < section.pictures.size(); ++i) {
    const ReportPicture& picture = section.pictures[i];
    if ((i == 0) != of_heading) continue;
    const std::string image =
        fmt::format("<img src=\"data:image/png;base64,{}\" alt=\"{}\">", base64(picture.png),
                    html_text(section.title + ": " + picture.title));
    text += i == 0 ? image : fmt::format("<h4>{}</h4>{}", html_text(picture.title), image);
  }
  if (of_heading || text.empty()) return text;
  return "<div class=\"block maps\"><h3>Where the work is</h3>" + text + "</div>\n";
}

/// The structures of a scene from fast to slow, by their mean ratio over the ray kinds.
std::string ranking_html(const Report& report, const ReportSection& section) {
  std::vector<std::pair<double, std::size_t>> order;
  for (const std::size_t spec : section.specs)
    if (const auto ratio = mean_ratio(section, spec)) order.emplace_back(-ratio->value, spec);
  std::ranges::sort(order);
  std::string text;
  for (const auto& [negative, spec] : order) {
    const auto ratio = mean_ratio(section, spec);
    text += fmt::format("<li data-spec=\"{}\">{}{} <b>{}</b> <span class=\"unit\">{}–{}</span></li>", spec,
                        swatch(report, spec), html_text(report.specs[spec].label), three_digits(ratio->value),
                        three_digits(ratio->low), three_digits(ratio->high));
  }
  if (text.empty()) return "";
  return fmt::format(
      "<p class=\"note\">From fast to slow, throughput over that of {} on {}:</p><ol "
      "class=\"ranking\">{}</ol>",
      html_text(report.specs[section.baseline].label),
      section.batches.size() == 1 ? "these rays" : "all kinds of rays (geometric mean)", text);
}

std::string section_html(const Report& report, std::size_t index) {
  const ReportSection& section = report.sections[index];
  const Record& first = section.records.front();
  std::string text = fmt::format(
      "<section class=\"scene\" id=\"scene-{0}\" data-section=\"{0}\"><header>{9}<h2>{1}</h2>"
      "<p class=\"sub\">{2}{3}{4} primitives · scene hash <code>{5}</code> · {6} thread{7} · {8} "
      "order</p>{10}</header>\n",
      index, html_text(section.title),
      section.setting.empty() ? "" : "<b>" + html_text(section.setting) + "</b> · ",
      section.scene == section.title ? "" : "<code>" + html_text(section.scene) + "</code> · ",
      grouped(first.primitives.value_or(0)), html_text(first.scene_hash), first.threads.value_or(1),
      first.threads.value_or(1) == 1 ? "" : "s", html_text(first.order), pictures_html(section, true),
      ranking_html(report, section));
  const std::string baseline = report.specs[section.baseline].label;
  text += figure(report, "ratio", index, "Throughput over that of " + baseline,
                 "ratio, with its " + interval_words(section), ratio_table(report, section));
  const std::vector<Sweep> swept = structure_sweeps(report, section);
  for (std::size_t i = 0; i < swept.size(); ++i) {
    const Table table = sweep_table(report, section, swept[i]);
    text += figure(report, "sweep", index, table.caption, "the least of each curve is marked", table, i);
  }
  text += "<div class=\"block\"><h3>Build, memory, throughput</h3>" +
          html_table(report, build_table(report, section)) + "</div>\n";
  text +=
      figure(report, "break-even", index, "Build and trace together",
             "seconds for so many rays: build time + rays / throughput", break_even_table(report, section));
  text += figure(report, "work", index, "Work per ray",
                 "dot: mean; bar: median to 99th percentile; tick: 90th; line: to the maximum",
                 work_table(report, section));
  text += pictures_html(section, false);
  const std::vector<std::string> said = remarks(report, section);
  if (!said.empty()) {
    text += "<div class=\"block remarks\"><h3>Remarks</h3><ul>";
    for (const std::string& remark : said) text += fmt::format("<li>{}</li>", html_text(remark));
    text += "</ul></div>\n";
  }
  return text + "</section>\n";
}

std::string verdict_html(const Report& report) {
  std::string text = "<dl class=\"verdict\">";
  for (const Finding& finding : verdict(report))
    text += fmt::format("<div{}><dt>{}</dt><dd>{}</dd></div>", finding.fault ? " class=\"fault\"" : "",
                        html_text(finding.head), html_text(finding.text));
  return text + "</dl>";
}

/// The lines of an environment that a reader looks for first.
std::string environment_brief(const Report& report) {
  std::string text;
  for (const auto& [id, entries] : report.environments) {
    std::string line;
    for (const char* wanted : {"cpu", "system", "compiler", "build_type", "embree"})
      for (const auto& [name, value] : entries)
        if (name == wanted) {
          if (!line.empty()) line += " · ";
          line += (name == "embree" ? "Embree " : "") + html_text(value);
        }
    text += fmt::format("<p class=\"sub\">{}</p>", line);
  }
  return text;
}

std::string environments_html(const Report& report) {
  std::string text;
  for (const auto& [id, entries] : report.environments) {
    text +=
        fmt::format("<table class=\"facts\"><caption>Environment <code>{}</code></caption>", html_text(id));
    for (const auto& [name, value] : entries)
      text += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>", html_text(name), html_text(value));
    text += "</table>";
  }
  return text;
}

std::string body(const Report& report) {
  std::string text =
      fmt::format("<header class=\"top\"><p class=\"kicker\">Raymeter report</p><h1>{}</h1>{}</header>\n",
                  html_text(question(report)), environment_brief(report));
  text += "<main>\n<div class=\"first\">" + verdict_html(report);
  if (!report.sections.empty()) {
    text += figure(report, "overview", 0, "At a glance",
                   "ratio to the baseline; dot: a scene and ray kind; diamond: mean", overview_table(report),
                   0, report.sections.size() > 1);
  }
  text += "</div>\n<div id=\"filters\"></div>\n";
  const std::vector<Sweep> swept = scene_sweeps(report);
  if (!swept.empty()) text += "<section class=\"scene\"><header><h2>Over the scenes</h2></header>";
  for (std::size_t i = 0; i < swept.size(); ++i) {
    const Table table = scene_sweep_table(report, swept[i]);
    text += figure(report, "scenes", 0, table.caption, "a line for each structure", table, i);
  }
  if (!swept.empty()) text += "</section>\n";
  for (std::size_t i = 0; i < report.sections.size(); ++i) text += section_html(report, i);
  text +=
      "<section class=\"facts\"><h2>Measured on</h2>" + environments_html(report) + "</section>\n</main>\n";
  text += fmt::format(
      "<footer>Made by Raymeter {}. The records are in records.csv and records.jsonl in the folders of "
      "the comparisons; <code>raymeter list columns</code> says what each column means.</footer>\n",
      RAYMETER_VERSION);
  return text;
}

}  // namespace

std::string report_page(const Report& report) {
  // The three places of the template, in the order in which they stand there.
  const std::pair<std::string_view, std::string> fillings[] = {
      {"<!--TITLE-->", html_text(question(report))},
      {"<!--BODY-->", body(report)},
      {"<!--DATA-->", json_in_script(report_json(report))}};
  std::string page;
  std::string_view rest = page_template;
  for (const auto& [place, filling] : fillings) {
    const std::size_t at = rest.find(place);
    page += rest.substr(0, at);
    page += filling;
    rest.remove_prefix(at + place.size());
  }
  page += rest;
  return page;
}

}  // namespace raymeter
