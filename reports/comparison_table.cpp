#include "reports/comparison_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace raymeter {
namespace {

constexpr std::size_t label_width = 26;
constexpr std::size_t page_width = 100;

std::string shortened(const std::string& text, std::size_t width) {
  return text.size() <= width ? text : text.substr(0, width - 2) + "..";
}

/// A number in a column of `width`, with as many decimals as keep about three digits; "-" when absent.
std::string number(const Record::Number& value, int width) {
  if (!value) return fmt::format("{:>{}}", "-", width);
  const int decimals = *value >= 100 ? 0 : *value >= 10 ? 1 : *value >= 1 ? 2 : 3;
  return fmt::format("{:>{}.{}f}", *value, width, decimals);
}

std::string grouped(std::uint64_t value) {
  std::string digits = fmt::format("{}", value);
  for (std::ptrdiff_t at = std::ssize(digits) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

/// "2 edge, 1 tie": the classes of grading other than `right` that are not empty.
std::string differences(const Record& record) {
  std::string text;
  for (const Column& column : columns()) {
    const auto* member = std::get_if<Record::Count Record::*>(&column.member);
    if (!member) continue;
    const bool is_class = column.name == "within_bound" || column.name == "tie" || column.name == "edge" ||
                          column.name == "grazing" || column.name == "at_limit" ||
                          column.name == "degenerate" || column.name == "wrong" ||
                          column.name == "not_given" || column.name == "unexplained";
    const Record::Count& count = record.**member;
    if (is_class && count.value_or(0) > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(*count), column.name);
  }
  return text;
}

std::string grade(const Record& record) {
  if (record.status != "ok") return record.status;
  if (const auto bad = record.wrong.value_or(0) + record.unexplained.value_or(0))
    return fmt::format("{} WRONG", bad);
  return record.right == record.rays ? "right" : "explained";
}

std::string brief_spec(const Record& record, const Registry& registry) {
  return registry.arguments(parse_spec(record.spec)).brief();
}

/// Breaks words so that lines fit the page, the first one indented by `indent`, the others by 2 more.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string result, line(indent, ' ');
  bool has_word = false;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (has_word && line.size() + 1 + word.size() > page_width) {
      result += line + "\n";
      line = std::string(indent + 2, ' ');
      has_word = false;
    }
    line += (has_word ? " " : "") + word;
    has_word = true;
    at = end + 1;
  }
  return result + line + "\n";
}

std::string row(const Record& record, const std::string& label) {
  std::string interval = "-";
  if (record.ratio_low && record.ratio_high)
    interval = fmt::format("{:.3f}..{:.3f}", *record.ratio_low, *record.ratio_high);
  auto milliseconds = record.build_s, megabytes = Record::Number{};
  if (milliseconds) *milliseconds *= 1e3;
  if (record.bytes) megabytes = static_cast<double>(*record.bytes) / 1e6;
  return fmt::format("  {:<{}}{}{}{}{}{} {:>14}{}{}  {}\n", shortened(label, label_width), label_width,
                     number(milliseconds, 8), number(megabytes, 7), number(record.mrays_per_s, 8),
                     number(record.ratio, 7), record.noisy.empty() ? " " : "~", interval,
                     number(record.steps_per_ray, 7), number(record.tests_per_ray, 7), grade(record));
}

}  // namespace

std::string comparison_table(std::span<const Record> records, const Registry& registry) {
  if (records.empty()) return "";
  const Record& first = records.front();
  std::string text = wrapped(fmt::format("{}  {} primitives, scene hash {}", first.scene,
                                         grouped(first.primitives.value_or(0)), first.scene_hash),
                             0);
  text +=
      wrapped(fmt::format("{} thread{}; Mray/s and ratio against {}: median of {} rounds, 95% interval",
                          first.threads.value_or(1), first.threads.value_or(1) == 1 ? "" : "s",
                          registry.arguments(parse_spec(first.baseline)).brief(), first.rounds.value_or(0)),
              0);

  std::vector<std::string> batches;
  for (const Record& record : records)
    if (std::ranges::find(batches, record.batch) == batches.end()) batches.push_back(record.batch);

  // Under the table, a paragraph for each structure and kind of remark: what is said, and of which batches.
  std::vector<std::pair<std::string, std::string>> remarks;
  const auto remark = [&](const std::string& head, const std::string& what) {
    const auto same = std::ranges::find(remarks, head, &std::pair<std::string, std::string>::first);
    if (same == remarks.end())
      remarks.emplace_back(head, what);
    else if (same->second.find(what) == std::string::npos)
      same->second += "; " + what;
  };
  for (const std::string& batch : batches) {
    bool titled = false;
    for (const Record& record : records) {
      if (record.batch != batch) continue;
      const std::string label = brief_spec(record, registry);
      if (!titled) {
        text += fmt::format("\n{}: {} rays, {} order, {} hit\n", batch, grouped(record.rays.value_or(0)),
                            record.order, record.query);
        text += fmt::format("  {:<{}}{:>8}{:>7}{:>8}{:>7}  {:>14}{:>7}{:>7}  {}\n", "structure", label_width,
                            "build ms", "MB", "Mray/s", "ratio", "95% interval", "steps", "tests", "grade");
        titled = true;
      }
      text += row(record, label);
      if (record.status == "ok" && record.right != record.rays)
        remark(label + " differs from the truth: ", fmt::format("{}: {}", batch, differences(record)));
      if (!record.note.empty()) remark(label + ": ", record.note);
      if (!record.noisy.empty())
        remark("~ noisy, interquartile range of the rounds' ratios: ",
               fmt::format("{} {} {:.0f}%", label, batch, 100 * record.spread.value_or(0)));
    }
  }
  if (!remarks.empty()) text += "\n";
  for (const auto& [head, what] : remarks) text += wrapped(head + what, 2);
  return text;
}

}  // namespace raymeter
