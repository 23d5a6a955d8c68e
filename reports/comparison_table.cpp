#include "reports/comparison_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "harness/statistics.h"
#include "reports/record_text.h"
#include "reports/text.h"

namespace raymeter {
namespace {

constexpr std::size_t label_width = 22;

/// A label that does not fit its column has a line of its own above the numbers.
std::string row(const Record& record, const std::string& label) {
  auto milliseconds = record.build_s, megabytes = Record::Number{};
  if (milliseconds) *milliseconds *= 1e3;
  if (record.bytes) megabytes = static_cast<double>(*record.bytes) / 1e6;
  const std::string interval =
      record.ratio_low ? three_digits(record.ratio_low) + ".." + three_digits(record.ratio_high) : "-";
  const bool fits = label.size() <= label_width;
  return (fits ? "" : wrapped("  ", label, 4)) +
         fmt::format("  {:<{}}{:>8}{:>8}{:>8}{:>8}{} {:>14}{:>8}{:>8} {}\n", fits ? label : "", label_width,
                     three_digits(milliseconds), three_digits(megabytes), three_digits(record.mrays_per_s),
                     three_digits(record.ratio), record.noisy.empty() ? " " : "~", interval,
                     three_digits(record.steps_per_ray), three_digits(record.tests_per_ray),
                     grade_text(record));
}

}  // namespace

std::string comparison_table(std::span<const Record> records, const Registry& registry) {
  if (records.empty()) return "";
  const Record& first = records.front();
  std::string text = wrapped("",
                             fmt::format("{}  {} primitives, scene hash {}", first.scene,
                                         grouped(first.primitives.value_or(0)), first.scene_hash),
                             2);
  std::uint64_t rounds = 0;
  for (const Record& record : records) rounds = std::max(rounds, record.rounds.value_or(0));
  text += wrapped(
      "",
      fmt::format("{} thread{}; ratio against {}: median of {} rounds and its {:.3g}% interval",
                  first.threads.value_or(1), first.threads.value_or(1) == 1 ? "" : "s",
                  brief_spec(first.baseline, registry), rounds, 100 * median_interval_confidence(rounds)),
      2);

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
  for (const std::string& canonical : batches) {
    const std::string batch = brief_batch(canonical);
    bool titled = false;
    for (const Record& record : records) {
      if (record.batch != canonical) continue;
      const std::string label = brief_spec(record.spec, registry);
      if (!titled) {
        text += fmt::format("\n{}: {} rays, {} order, {} hit\n", batch, grouped(record.rays.value_or(0)),
                            record.order, record.query);
        text += fmt::format("  {:<{}}{:>8}{:>8}{:>8}{:>8}  {:>14}{:>8}{:>8} {}\n", "structure", label_width,
                            "build ms", "MB", "Mray/s", "ratio", "interval", "steps", "tests", "grade");
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
  for (const auto& [head, what] : remarks) text += wrapped("  ", head + what, 4);
  return text;
}

}  // namespace raymeter
