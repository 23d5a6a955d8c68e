#include "reports/sweeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>

#include "scenes/base/error.h"
#include "scenes/base/spec.h"

namespace raymeter {
namespace {

using Parameters = std::vector<std::pair<std::string, std::string>>;

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

std::vector<Sweep> sweeps_among(std::span<const std::pair<std::size_t, std::string>> specs) {
  std::map<std::size_t, Spec> parsed;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> values_of;  // name, parameter
  for (const auto& [index, text] : specs) {
    try {
      parsed[index] = parse_spec(text);
    } catch (const Error&) {
      parsed.erase(index);
      continue;
    }
    for (const auto& [name, value] : parsed[index].parameters)
      values_of[{parsed[index].name, name}].insert(value);
  }

  std::vector<Sweep> found;
  for (const auto& [key, values] : values_of) {
    if (values.size() < 3) continue;
    const auto& [name, parameter] = key;
    std::map<Parameters, std::vector<std::pair<double, std::size_t>>> curves;  // by the other parameters
    for (const auto& [index, spec] : parsed) {
      if (spec.name != name) continue;
      Parameters others;
      std::optional<double> value;
      for (const auto& [of, text] : spec.parameters)
        if (of == parameter)
          value = number_in(text);
        else
          others.emplace_back(of, text);
      if (value) curves[others].emplace_back(*value, index);
    }
    for (auto& [others, points] : curves) {
      if (points.size() < 3) continue;
      std::ranges::sort(points);
      Sweep sweep{name, parameter, "", {}, {}};
      for (const auto& [of, text] : others)
        if (values_of[{name, of}].size() > 1)
          sweep.fixed += fmt::format("{}{}={}", sweep.fixed.empty() ? "" : ":", of, text);
      for (const auto& [value, index] : points) {
        sweep.values.push_back(value);
        sweep.indices.push_back(index);
      }
      found.push_back(std::move(sweep));
    }
  }
  return found;
}

std::vector<Sweep> structure_sweeps(const Report& report, const ReportSection& section) {
  std::vector<std::pair<std::size_t, std::string>> specs;
  for (const std::size_t spec : section.specs) specs.emplace_back(spec, report.specs[spec].canonical);
  return sweeps_among(specs);
}

std::vector<Sweep> scene_sweeps(const Report& report) {
  std::map<std::string, std::vector<std::pair<std::size_t, std::string>>> scenes;  // by setting
  for (std::size_t i = 0; i < report.sections.size(); ++i)
    scenes[report.sections[i].setting].emplace_back(i, report.sections[i].scene);
  std::vector<Sweep> found;
  for (const auto& [setting, specs] : scenes)
    std::ranges::move(sweeps_among(specs), std::back_inserter(found));
  return found;
}

}  // namespace raymeter
