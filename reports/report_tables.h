#pragma once
#include "reports/report.h"
#include "reports/sweeps.h"
#include "reports/table.h"

namespace raymeter {

/// The structures against the scenes: mean ratio to the baseline over the ray kinds; one that is the fastest
/// within its interval is the best of its scene.
Table overview_table(const Report& report);

/// What each structure costs: build time, memory, cells, and throughput for each ray kind.
Table build_table(const Report& report, const ReportSection& section);

/// Ratio, interval and grade of every race.
Table ratio_table(const Report& report, const ReportSection& section);

/// Steps and tests per ray: mean and distribution. Without the structures that can't be counted in.
Table work_table(const Report& report, const ReportSection& section);

/// For how many rays each structure is worth its build.
Table break_even_table(const Report& report, const ReportSection& section);

/// A structure over one of its parameters: time, steps, tests, memory.
Table sweep_table(const Report& report, const ReportSection& section, const Sweep& sweep);

/// All structures over one parameter of the scenes: time and tests for each ray kind.
Table scene_sweep_table(const Report& report, const Sweep& sweep);

/// Below the tables, in words: what a number alone would hide. A paragraph each: differences by class,
/// clamps, failures, noise.
std::vector<std::string> remarks(const Report& report, const ReportSection& section);

/// How sure intervals are: "93.8% intervals (5 rounds)".
std::string interval_words(const ReportSection& section);

}  // namespace raymeter
