#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "reports/report.h"

namespace raymeter {

/// Specs of one name over one numeric parameter, all others fixed.
struct Sweep {
  std::string name, parameter;
  std::string fixed;                 ///< the other parameters that vary elsewhere, as a=1:b=2
  std::vector<std::size_t> indices;  ///< of the specs
  std::vector<double> values;        ///< of the parameter, rising
};

/// The sweeps of three or more values among some specs (index, canonical text). What is no spec is left out.
std::vector<Sweep> sweeps_among(std::span<const std::pair<std::size_t, std::string>> specs);

/// Of the structures of a section: indices of the report's specs.
std::vector<Sweep> structure_sweeps(const Report& report, const ReportSection& section);

/// Of the generated scenes that were measured under one setting: indices of sections.
std::vector<Sweep> scene_sweeps(const Report& report);

}  // namespace raymeter
