#pragma once
#include <string>

#include "reports/report.h"

namespace raymeter {

/// The report as one HTML file that needs nothing else: styles, scripts and data are in it, and every chart
/// has its numbers as a table.
std::string report_page(const Report& report);

/// The tables of the report with the verdict, in Markdown.
std::string report_markdown(const Report& report);

/// The tables of the report, for \input in a LaTeX document that uses booktabs.
std::string report_latex(const Report& report);

}  // namespace raymeter
