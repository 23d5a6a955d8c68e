#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "accel/registry.h"
#include "harness/record.h"

namespace raymeter {

/// A number to about three digits; "-" when absent.
std::string three_digits(const Record::Number& value);

/// 1,234,567.
std::string grouped(std::uint64_t value);

/// "2 edge, 1 tie": the classes of grading other than `right` that are not empty.
std::string differences(const Record& record);

/// "right", "explained", "10 WRONG", "failed" and the like.
std::string grade_text(const Record& record);

/// What tables call a structure: the spec less what is at its default; the spec as it stands where the
/// registry does not know it.
std::string brief_spec(const std::string& spec, const Registry& registry);

/// The same of a generated scene; a file's name as it stands.
std::string brief_scene(const std::string& scene);

/// The same of a ray kind. Of rays from a file the batch's name says more, and stays as it is.
std::string brief_batch(const std::string& batch);

}  // namespace raymeter
