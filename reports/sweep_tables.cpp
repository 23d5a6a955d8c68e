#include <fmt/format.h>

#include <algorithm>

#include "reports/report_tables.h"
#include "reports/table_cells.h"

namespace raymeter {
namespace {

std::string caption_of(const Sweep& sweep) {
  return fmt::format("{} over {}{}", sweep.name, sweep.parameter,
                     sweep.fixed.empty() ? "" : " at " + sweep.fixed);
}

}  // namespace

Table sweep_table(const Report& report, const ReportSection& section, const Sweep& sweep) {
  Table table;
  table.caption = caption_of(sweep);
  table.columns = {text_column("Rays"), {sweep.parameter, ""}, {"Time", "ns/ray"}, {"Steps", "1/ray"},
                   {"Tests", "1/ray"},  {"Held", "MB"},        {"Build", "ms"}};
  for (const std::size_t batch : section.batches) {
    std::vector<TableRow> rows;
    std::vector<Record::Number> times, steps, tests;
    for (std::size_t i = 0; i < sweep.indices.size(); ++i) {
      const Record* r = section.find(sweep.indices[i], batch);
      if (!r) continue;
      times.push_back(time_per_ray(*r));
      steps.push_back(r->steps_per_ray);
      tests.push_back(r->tests_per_ray);
      TableRow row;
      row.spec = sweep.indices[i];
      row.batch = batch;
      row.begins_group = rows.empty();
      row.cells = {{report.batches[batch].label}, {fmt::format("{}", sweep.values[i])},
                   number_cell(times.back()),     number_cell(steps.back()),
                   number_cell(tests.back()),     megabytes_cell(r->bytes),
                   number_cell(r->build_s, 1e3)};
      rows.push_back(std::move(row));
    }
    std::size_t column = 2;
    for (const auto& values : {times, steps, tests}) {
      std::size_t least = values.size();
      for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] && (least == values.size() || *values[i] < *values[least])) least = i;
      if (least < values.size()) rows[least].cells[column].mark = Mark::best;
      ++column;
    }
    for (TableRow& row : rows) table.rows.push_back(std::move(row));
  }
  table.note = "Bold: the least.";
  return table;
}

Table scene_sweep_table(const Report& report, const Sweep& sweep) {
  Table table;
  table.caption = caption_of(sweep);
  table.columns = {text_column("Rays"), text_column("Structure"), {sweep.parameter, ""}, {"Time", "ns/ray"},
                   {"Steps", "1/ray"},  {"Tests", "1/ray"},       {"Held", "MB"},        {"Build", "ms"}};
  for (std::size_t batch = 0; batch < report.batches.size(); ++batch)
    for (std::size_t spec = 0; spec < report.specs.size(); ++spec) {
      bool first = true;
      for (std::size_t i = 0; i < sweep.indices.size(); ++i) {
        const Record* r = report.sections[sweep.indices[i]].find(spec, batch);
        if (!r) continue;
        TableRow row;
        row.spec = spec;
        row.batch = batch;
        row.section = sweep.indices[i];
        row.begins_group = first;
        row.cells = {{report.batches[batch].label},
                     {report.specs[spec].label},
                     {fmt::format("{}", sweep.values[i])},
                     number_cell(time_per_ray(*r)),
                     number_cell(r->steps_per_ray),
                     number_cell(r->tests_per_ray),
                     megabytes_cell(r->bytes),
                     number_cell(r->build_s, 1e3)};
        table.rows.push_back(std::move(row));
        first = false;
      }
    }
  return table;
}

}  // namespace raymeter
