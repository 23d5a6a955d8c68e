#pragma once
#include <string>

#include "reports/report.h"

namespace raymeter {

/// What the page's scripts draw from, as JSON: specs, batches, sections with their records as rows of the
/// `columns`, and sweeps. Invalid UTF-8 is replaced.
std::string report_json(const Report& report);

}  // namespace raymeter
