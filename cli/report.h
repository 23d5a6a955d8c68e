#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "accel/registry.h"

namespace raymeter {

/// What `raymeter report` was asked.
struct ReportOptions {
  std::vector<std::string> folders;
  std::string out;  ///< .html, .md, .tex or .csv
  bool diff = false;
  double tolerance = 10;  ///< percent
};

/// Writes the report of the records in some folders, or says what changed between two of them. Returns the
/// exit status: 0; 1 when of a diff something got worse. Throws Error.
int run_report(const ReportOptions& options, const Registry& registry);

/// Writes report.html into the folder of a run. Throws Error.
void write_report_page(const std::filesystem::path& folder, const Registry& registry);

}  // namespace raymeter
