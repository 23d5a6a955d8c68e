#pragma once
#include <string>
#include <vector>

#include "reports/report.h"

namespace raymeter {

/// A sentence of the verdict, in plain text.
struct Finding {
  std::string head;  ///< what it is about: "Fastest"
  std::string text;
  bool fault = false;  ///< a reader must not overlook it
};

/// What the report answers, as a question: "What traces soup fastest, and is every answer right?"
std::string question(const Report& report);

/// The answer in plain numbers: what was raced, who is fastest and by how much, how sure that is, and whether
/// all answers were right.
std::vector<Finding> verdict(const Report& report);

}  // namespace raymeter
