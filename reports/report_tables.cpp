#include "reports/report_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/statistics.h"
#include "reports/break_even.h"
#include "reports/record_text.h"
#include "reports/table_cells.h"

namespace raymeter {
namespace {

std::string interval_of(const Record::Number& low, const Record::Number& high) {
  return low && high ? fmt::format("{}–{}", three_digits(low), three_digits(high)) : "-";
}

bool is_fault(const Record& record) {
  const auto some = [](const Record::Count& count) { return count.value_or(0) > 0; };
  return record.status != "ok" || some(record.wrong) || some(record.unexplained);
}

TableCell grade_cell(const Record& record) {
  return {grade_text(record), is_fault(record) ? Mark::fault : Mark::plain};
}

/// Any record of a structure that was built, for what does not depend on the rays.
const Record* any_record(const ReportSection& section, std::size_t spec) {
  const Record* found = nullptr;
  for (const std::size_t batch : section.batches)
    if (const Record* record = section.find(spec, batch); record && (!found || !found->build_s))
      found = record;
  return found;
}

/// The highest lower end of an interval among those of `records`: who reaches it may be the fastest.
template <class Low>
double level_to_reach(const std::vector<std::size_t>& specs, const Low& low) {
  double best = 0;
  for (const std::size_t spec : specs) best = std::max(best, low(spec));
  return best;
}

}  // namespace

std::string interval_words(const ReportSection& section) {
  std::uint64_t rounds = 0;
  for (const Record& record : section.records) rounds = std::max(rounds, record.rounds.value_or(0));
  if (rounds < 3) return "too few rounds for intervals";
  return fmt::format("{:.3g}% interval, {} rounds", 100 * median_interval_confidence(rounds), rounds);
}

Table overview_table(const Report& report) {
  Table table;
  table.caption = "Throughput over the baseline's, geometric mean of the ray kinds";
  table.columns.push_back(text_column("Scene"));
  std::vector<std::size_t> specs;
  for (std::size_t spec = 0; spec < report.specs.size(); ++spec) {
    const bool measured = std::ranges::any_of(report.sections, [&](const ReportSection& section) {
      return std::ranges::find(section.specs, spec) != section.specs.end();
    });
    if (!measured) continue;
    specs.push_back(spec);
    table.columns.push_back({report.specs[spec].label, "", true, spec});
  }
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const ReportSection& section = report.sections[i];
    const auto low = [&](std::size_t spec) {
      const auto ratio = mean_ratio(section, spec);
      return ratio ? ratio->low : 0;
    };
    const double level = level_to_reach(section.specs, low);
    TableRow row;
    row.section = i;
    row.cells.push_back({section.title + (section.setting.empty() ? "" : " (" + section.setting + ")")});
    for (const std::size_t spec : specs) {
      const auto ratio = mean_ratio(section, spec);
      TableCell cell{"-", Mark::plain, spec};
      if (ratio) {
        cell.text = three_digits(ratio->value);
        if (ratio->high >= level) cell.mark = Mark::best;
      }
      const Record* record = any_record(section, spec);
      if (record && !record->build_s) cell = {"failed", Mark::fault, spec};
      row.cells.push_back(cell);
    }
    table.rows.push_back(std::move(row));
  }
  table.note = "Bold: no other structure is faster beyond both intervals.";
  return table;
}

Table build_table(const Report& report, const ReportSection& section) {
  Table table;
  table.caption = "Build, memory, throughput";
  table.columns = {text_column("Structure"), {"Build", "ms"}, {"Held", "MB"},
                   {"Peak", "MB"},           {"Cells", ""},   {"References", ""}};
  for (const std::size_t batch : section.batches)
    table.columns.push_back({report.batches[batch].label, "Mray/s", true, {}, batch});
  for (const std::size_t spec : section.specs) {
    const Record* any = any_record(section, spec);
    TableRow row;
    row.spec = spec;
    row.cells = {{report.specs[spec].label}, number_cell(any->build_s, 1e3),
                 megabytes_cell(any->bytes), megabytes_cell(any->peak_bytes),
                 count_cell(any->cells),     count_cell(any->references)};
    for (const std::size_t batch : section.batches) {
      const Record* record = section.find(spec, batch);
      if (!record)
        row.cells.push_back({"-"});
      else if (record->status != "ok")
        row.cells.push_back({record->status, Mark::fault});
      else
        row.cells.push_back(
            {three_digits(record->mrays_per_s), record->noisy.empty() ? Mark::plain : Mark::noisy});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table ratio_table(const Report& report, const ReportSection& section) {
  Table table;
  table.caption = fmt::format("Throughput over that of {}", report.specs[section.baseline].label);
  table.columns = {text_column("Rays"),
                   text_column("Structure"),
                   {"Throughput", "Mray/s"},
                   {"Ratio", ""},
                   {"Interval", ""}};
  const bool has_envelope = std::ranges::any_of(
      section.batches, [&](std::size_t batch) { return envelope(report, section, batch) != nullptr; });
  if (has_envelope) table.columns.push_back({"To envelope", ""});
  table.columns.push_back(text_column("Answers"));
  for (const std::size_t batch : section.batches) {
    const auto low = [&](std::size_t spec) {
      const Record* record = section.find(spec, batch);
      return record ? record->ratio_low.value_or(record->ratio.value_or(0)) : 0;
    };
    const double level = level_to_reach(section.specs, low);
    const Record* best = envelope(report, section, batch);
    bool first = true;
    for (const std::size_t spec : section.specs) {
      const Record* record = section.find(spec, batch);
      if (!record) continue;
      const bool reaches = record->ratio && record->ratio_high.value_or(*record->ratio) >= level;
      TableRow row;
      row.spec = spec;
      row.batch = batch;
      row.begins_group = first;
      row.cells = {{report.batches[batch].label},
                   {report.specs[spec].label},
                   number_cell(record->mrays_per_s),
                   {three_digits(record->ratio), reaches                  ? Mark::best
                                                 : !record->noisy.empty() ? Mark::noisy
                                                                          : Mark::plain},
                   {interval_of(record->ratio_low, record->ratio_high)}};
      if (has_envelope)
        row.cells.push_back({three_digits(
            best && record->ratio ? Record::Number(*record->ratio / *best->ratio) : Record::Number())});
      row.cells.push_back(grade_cell(*record));
      table.rows.push_back(std::move(row));
      first = false;
    }
  }
  table.note = fmt::format(
      "Ratio: median of the rounds' ratios of one race, and its {}. Bold: no other structure is faster "
      "beyond "
      "both intervals. The baseline's own row is a race against a second copy of itself: the floor of the "
      "method.",
      interval_words(section));
  if (has_envelope)
    table.note += fmt::format(" Envelope: the fastest of the settings of {} that were raced on these rays.",
                              report.specs[section.baseline].structure);
  return table;
}

Table work_table(const Report& report, const ReportSection& section) {
  Table table;
  table.caption = "Work per ray";
  table.columns = {text_column("Rays"), text_column("Structure")};
  for (const char* what : {"Steps", "Tests"})
    for (const char* of : {" mean", " p50", " p90", " p99", " max"})
      table.columns.push_back({std::string(what) + of});
  table.columns.push_back({"Empty steps", "%"});
  table.columns.push_back({"Repeated tests", "%"});
  const auto percent = [](const Record::Number& part, const Record::Number& whole) {
    return TableCell{part && whole && *whole > 0 ? fmt::format("{:.0f}", 100 * *part / *whole) : "-"};
  };
  for (const std::size_t batch : section.batches) {
    bool first = true;
    for (const std::size_t spec : section.specs) {
      const Record* r = section.find(spec, batch);
      if (!r || !r->steps_per_ray) continue;
      TableRow row;
      row.spec = spec;
      row.batch = batch;
      row.begins_group = first;
      row.cells = {{report.batches[batch].label}, {report.specs[spec].label}};
      row.cells.push_back(number_cell(r->steps_per_ray));
      for (const Record::Count& count : {r->steps_p50, r->steps_p90, r->steps_p99, r->steps_max})
        row.cells.push_back(count_cell(count));
      row.cells.push_back(number_cell(r->tests_per_ray));
      for (const Record::Count& count : {r->tests_p50, r->tests_p90, r->tests_p99, r->tests_max})
        row.cells.push_back(count_cell(count));
      row.cells.push_back(percent(r->empty_cell_steps_per_ray, r->steps_per_ray));
      const Record::Number repeated = r->distinct_tests_per_ray && r->tests_per_ray
                                          ? Record::Number(*r->tests_per_ray - *r->distinct_tests_per_ray)
                                          : Record::Number();
      row.cells.push_back(percent(repeated, r->tests_per_ray));
      table.rows.push_back(std::move(row));
      first = false;
    }
  }
  table.note =
      "Steps: cells and nodes visited, inner ones too. Tests: ray-primitive tests. A step is not the same "
      "work in "
      "every structure: compare steps within one structure, not across. Percentiles above 64 are at most "
      "1/32 high.";
  return table;
}

Table break_even_table(const Report& report, const ReportSection& section) {
  const std::string& baseline = report.specs[section.baseline].label;
  Table table;
  table.caption = "Build and trace together";
  table.columns = {text_column("Rays"),      text_column("Structure"), {"Build", "ms"},
                   {"Throughput", "Mray/s"}, {"Beats " + baseline},    {"Fastest of all"}};
  for (const std::size_t batch : section.batches) {
    std::vector<std::size_t> specs;
    std::vector<Cost> costs;
    std::optional<Cost> base;
    for (const std::size_t spec : section.specs) {
      const Record* r = section.find(spec, batch);
      if (!r || !r->build_s || !r->mrays_per_s || !(*r->mrays_per_s > 0)) continue;
      specs.push_back(spec);
      costs.push_back({*r->build_s, *r->mrays_per_s * 1e6});
      if (spec == section.baseline) base = costs.back();
    }
    const std::vector<CheapestFor> ranges = cheapest(costs);
    for (std::size_t i = 0; i < specs.size(); ++i) {
      TableRow row;
      row.spec = specs[i];
      row.batch = batch;
      row.begins_group = i == 0;
      std::string range;
      for (const CheapestFor& r : ranges)
        if (r.index == i) range = fmt::format("{}–{} rays", rough_count(r.from), rough_count(r.to));
      row.cells = {{report.batches[batch].label},
                   {report.specs[specs[i]].label},
                   number_cell(costs[i].build_s, 1e3),
                   number_cell(costs[i].rays_per_s, 1e-6),
                   {specs[i] == section.baseline || !base ? "-" : cheaper_when(costs[i], *base)},
                   {range.empty() ? "-" : range, range.empty() ? Mark::plain : Mark::best}};
      table.rows.push_back(std::move(row));
    }
  }
  table.note = "Time for N rays: build time + N / throughput.";
  return table;
}

std::vector<std::string> remarks(const Report& report, const ReportSection& section) {
  std::vector<std::pair<std::string, std::string>> found;  // who and what; on which rays
  const auto remark = [&](const std::string& head, const std::string& what) {
    const auto same = std::ranges::find(found, head, &std::pair<std::string, std::string>::first);
    if (same == found.end())
      found.emplace_back(head, what);
    else if (!what.empty())
      same->second += "; " + what;
  };
  std::vector<std::pair<std::string, std::string>> noise;  // of whom; on which rays
  for (std::size_t i = 0; i < section.records.size(); ++i) {
    const Record& r = section.records[i];
    const std::string &label = report.specs[section.spec_of[i]].label,
                      &batch = report.batches[section.batch_of[i]].label;
    if (r.status == "ok" && r.right != r.rays)
      remark(label + " differs from the truth: ", fmt::format("{}: {}", batch, differences(r)));
    if (!r.note.empty()) remark(label + ": " + r.note, "");
    if (r.noisy.empty()) continue;
    auto same = std::ranges::find(noise, label, &std::pair<std::string, std::string>::first);
    if (same == noise.end()) same = noise.insert(noise.end(), {label, ""});
    same->second +=
        fmt::format("{}{} {:.0f}%", same->second.empty() ? "" : ", ", batch, 100 * r.spread.value_or(0));
  }
  std::vector<std::string> paragraphs;
  for (const auto& [head, what] : found) paragraphs.push_back(head + what);
  std::string noisy;
  for (const auto& [label, where] : noise)
    noisy += fmt::format("{}{}: {}", noisy.empty() ? "" : "; ", label, where);
  if (!noisy.empty()) paragraphs.push_back("~ noisy, interquartile range of the rounds' ratios. " + noisy);
  return paragraphs;
}

}  // namespace raymeter
