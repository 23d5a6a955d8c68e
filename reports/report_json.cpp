#include "reports/report_json.h"

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "reports/record_text.h"
#include "reports/sweeps.h"

namespace raymeter {
namespace {

using Json = nlohmann::ordered_json;

/// The columns of records that charts need.
constexpr std::array<std::string_view, 24> charted = {
    "rays",       "hits",          "build_s",       "bytes",     "peak_bytes", "cells",
    "references", "steps_per_ray", "tests_per_ray", "steps_p50", "steps_p90",  "steps_p99",
    "steps_max",  "tests_p50",     "tests_p90",     "tests_p99", "tests_max",  "mrays_per_s",
    "ratio",      "ratio_low",     "ratio_high",    "noisy",     "status",     "note"};

Json value_of(const Column& column, const Record& record) {
  return std::visit(
      [&](auto pointer) -> Json {
        const auto& value = record.*pointer;
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Record::Text>)
          return value.empty() ? Json() : Json(value);
        else
          return value ? Json(*value) : Json();
      },
      column.member);
}

Json sweeps_json(const std::vector<Sweep>& sweeps, const char* of) {
  Json json = Json::array();
  for (const Sweep& sweep : sweeps)
    json.push_back({{"parameter", sweep.parameter}, {of, sweep.indices}, {"values", sweep.values}});
  return json;
}

Json section_json(const Report& report, const ReportSection& section) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < section.records.size(); ++i) {
    Json row = Json::array({section.spec_of[i], section.batch_of[i], grade_text(section.records[i])});
    for (const Column& column : columns())
      if (std::ranges::find(charted, column.name) != charted.end())
        row.push_back(value_of(column, section.records[i]));
    rows.push_back(std::move(row));
  }
  return {{"title", section.title},
          {"setting", section.setting},
          {"baseline", section.baseline},
          {"specs", section.specs},
          {"batches", section.batches},
          {"rows", std::move(rows)},
          {"sweeps", sweeps_json(structure_sweeps(report, section), "specs")}};
}

}  // namespace

std::string report_json(const Report& report) {
  Json json;
  json["columns"] = {"spec", "batch", "grade"};
  for (const Column& column : columns())
    if (std::ranges::find(charted, column.name) != charted.end()) json["columns"].push_back(column.name);
  json["specs"] = Json::array();
  for (const ReportSpec& spec : report.specs)
    json["specs"].push_back({{"label", spec.label}, {"structure", spec.structure}, {"colour", spec.colour}});
  json["batches"] = Json::array();
  for (const ReportBatch& batch : report.batches) json["batches"].push_back(batch.label);
  json["sections"] = Json::array();
  for (const ReportSection& section : report.sections)
    json["sections"].push_back(section_json(report, section));
  json["sceneSweeps"] = sweeps_json(scene_sweeps(report), "sections");
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace raymeter
