#include "reports/record_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "harness/grading.h"
#include "harness/ray_kinds.h"
#include "scenes/base/error.h"
#include "scenes/generators/generators.h"

namespace raymeter {

std::string three_digits(const Record::Number& value) {
  if (!value) return "-";
  if (*value != 0 && *value < 0.01) return fmt::format("{:.1e}", *value);
  return fmt::format("{:.{}f}", *value, *value >= 100 ? 0 : *value >= 10 ? 1 : *value >= 1 ? 2 : 3);
}

std::string grouped(std::uint64_t value) {
  std::string digits = fmt::format("{}", value);
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

std::string differences(const Record& record) {
  std::string text;
  for (std::size_t grade = 1; grade < grade_count; ++grade) {
    const std::string_view name = name_of(static_cast<Grade>(grade));
    const Column& column = *std::ranges::find(columns(), name, &Column::name);
    const Record::Count& count = record.*std::get<Record::Count Record::*>(column.member);
    if (count.value_or(0) > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(*count), name);
  }
  return text;
}

std::string grade_text(const Record& record) {
  if (record.status != "ok") return record.status;
  if (record.wrong.value_or(0)) return fmt::format("{} WRONG", *record.wrong);
  if (record.unexplained.value_or(0)) return fmt::format("{} unexamined", *record.unexplained);
  if (record.not_given.value_or(0)) return fmt::format("{} not given", *record.not_given);
  return record.right == record.rays ? "right" : "explained";
}

std::string brief_spec(const std::string& spec, const Registry& registry) {
  try {
    return registry.arguments(parse_spec(spec)).brief();
  } catch (const Error&) {
    return spec;  // of a plug-in that is not loaded, or of another version
  }
}

std::string brief_scene(const std::string& scene) {
  const auto generator =
      std::ranges::find(scene_generators(), scene.substr(0, scene.find(':')), &SceneGenerator::name);
  if (generator == scene_generators().end()) return scene;
  try {
    return Arguments(parse_spec(scene), generator->parameters).brief();
  } catch (const Error&) {
    return scene;
  }
}

std::string brief_batch(const std::string& batch) {
  if (batch.find(' ') != std::string::npos) return batch;  // of a file: its kind may be anybody's
  try {
    return ray_arguments(parse_spec(batch)).brief();
  } catch (const Error&) {
    return batch;
  }
}

}  // namespace raymeter
