#include "reports/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reports/record_text.h"

namespace raymeter {
namespace {

/// "1 scene", "2 scenes".
std::string counted(std::size_t count, const std::string& noun) {
  return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

/// Of batches: one is the rays of one kind on one scene.
std::string sets_of_rays(std::size_t count) {
  return counted(count, "set") + " of rays";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

/// What is known of one spec over all races.
struct Tally {
  std::size_t fastest = 0, races = 0;
  double log_sum = 0, least = 0, most = 0;
  std::uint64_t rays = 0, right = 0, wrong = 0, unexplained = 0, not_given = 0;
  std::set<std::string> failures, notes;

  double mean() const { return std::exp(log_sum / static_cast<double>(races)); }
};

struct Tallies {
  std::map<std::size_t, Tally> of;  ///< by spec
  std::size_t batches = 0, races = 0, noisy = 0;
  double floor = 0;  ///< how far the baseline strays from itself
  std::set<std::string> scenes;
};

void add(Tally& tally, const Record& r) {
  if (r.status != "ok")
    tally.failures.insert(r.note.empty() ? r.status : r.note);
  else if (!r.note.empty())
    tally.notes.insert(r.note);
  if (r.right) {
    tally.rays += r.rays.value_or(0);
    tally.right += *r.right;
    tally.wrong += r.wrong.value_or(0);
    tally.unexplained += r.unexplained.value_or(0);
    tally.not_given += r.not_given.value_or(0);
  }
  if (!r.ratio || !(*r.ratio > 0)) return;
  tally.least = tally.races ? std::min(tally.least, *r.ratio) : *r.ratio;
  tally.most = std::max(tally.most, *r.ratio);
  tally.log_sum += std::log(*r.ratio);
  ++tally.races;
}

Tallies tallies(const Report& report) {
  Tallies all;
  for (const ReportSection& section : report.sections) {
    all.scenes.insert(section.title);
    for (const std::size_t batch : section.batches) {
      const Record* fastest = nullptr;
      std::size_t fastest_spec = 0;
      for (const std::size_t spec : section.specs) {
        const Record* r = section.find(spec, batch);
        if (!r) continue;
        add(all.of[spec], *r);
        if (!r->ratio) continue;
        ++all.races;
        if (!r->noisy.empty()) ++all.noisy;
        if (spec == section.baseline) all.floor = std::max(all.floor, std::abs(*r->ratio - 1));
        if (!fastest || *r->ratio > *fastest->ratio) {
          fastest = r;
          fastest_spec = spec;
        }
      }
      if (!fastest) continue;
      ++all.batches;
      ++all.of[fastest_spec].fastest;
    }
  }
  return all;
}

/// Orders (count, what): the highest count first.
constexpr auto more_first = [](const auto& a, const auto& b) {
  return a.first != b.first ? a.first > b.first : a.second < b.second;
};

/// Wins by structure; where several of its specs win, the best of them if it stands out.
Finding fastest(const Report& report, const Tallies& all) {
  std::map<std::string, std::vector<std::pair<std::size_t, std::size_t>>> wins;  // of its specs, and which
  for (const auto& [spec, tally] : all.of)
    if (tally.fastest) wins[report.specs[spec].structure].emplace_back(tally.fastest, spec);
  if (wins.empty()) return {"Fastest", "nothing was timed."};
  std::vector<std::pair<std::size_t, std::string>> order;
  for (auto& [structure, specs] : wins) {
    std::ranges::sort(specs, more_first);
    std::size_t count = 0;
    for (const auto& [of_spec, spec] : specs) count += of_spec;
    const std::string& best = report.specs[specs[0].second].label;
    std::string name = specs.size() == 1 ? best : structure;
    if (all.batches > 1)
      name +=
          count < all.batches ? fmt::format(" on {}", count) : fmt::format(" on all {}", sets_of_rays(count));
    if (specs.size() > 1) {
      const bool differ = all.of.at(specs[0].second).mean() > 1.05 * all.of.at(specs[1].second).mean();
      name += differ ? fmt::format(", most often as {}", best) : ", in settings that are about level";
    }
    order.emplace_back(count, name);
  }
  std::ranges::sort(order, more_first);
  std::vector<std::string> names;
  for (const auto& [count, name] : order) names.push_back(name);
  return {"Fastest",
          listed(names) + (names.size() > 1 ? fmt::format(", of {}.", sets_of_rays(all.batches)) : ".")};
}

/// The best of what is not of the baseline's kind, among those that ran everywhere.
Finding best_other(const Report& report, const Tallies& all) {
  const std::size_t baseline = report.sections[0].baseline;
  const Tally* best = nullptr;
  std::size_t best_spec = 0;
  for (const auto& [spec, tally] : all.of) {
    if (report.specs[spec].structure == report.specs[baseline].structure || tally.races == 0) continue;
    if (!best || tally.races > best->races || (tally.races == best->races && tally.mean() > best->mean())) {
      best = &tally;
      best_spec = spec;
    }
  }
  const std::string& name = report.specs[baseline].label;
  if (!best) return {};
  std::string text = fmt::format("{} traces at {} of the throughput of {}", report.specs[best_spec].label,
                                 three_digits(best->mean()), name);
  if (best->races > 1)
    text += fmt::format(" (geometric mean of {}; {} to {} on single ones)", sets_of_rays(best->races),
                        three_digits(best->least), three_digits(best->most));
  return {"Best beside it", text + "."};
}

Finding how_sure(const Report& report, const Tallies& all) {
  std::string text = all.noisy ? fmt::format("{} of {} are noisy (marked ~).", grouped(all.noisy),
                                             counted(all.races, "race"))
                               : fmt::format("none of {} is noisy.", counted(all.races, "race"));
  text +=
      fmt::format(" Raced against itself, {} comes out up to {:.1f}% off: smaller differences mean nothing.",
                  report.specs[report.sections[0].baseline].label, 100 * all.floor);
  return {"How sure", text};
}

void add_answers(std::vector<Finding>& findings, const Report& report, const Tallies& all) {
  std::vector<std::string> right;
  std::map<std::string, std::vector<std::string>> explained;  // by how much they differ
  for (const auto& [spec, tally] : all.of) {
    const std::string& label = report.specs[spec].label;
    for (const std::string& failure : tally.failures)
      findings.push_back({"Failed", fmt::format("{}: {}.", label, failure), true});
    if (tally.wrong)
      findings.push_back({"Wrong",
                          fmt::format("{}: {} of {} answers contradict brute force.", label,
                                      grouped(tally.wrong), grouped(tally.rays)),
                          true});
    if (tally.unexplained)
      findings.push_back({"Unexamined",
                          fmt::format("{}: {} of {} answers differ and were not examined.", label,
                                      grouped(tally.unexplained), grouped(tally.rays)),
                          true});
    if (tally.not_given)
      findings.push_back({"Not given",
                          fmt::format("{}: {} of {} rays were not answered.", label, grouped(tally.not_given),
                                      grouped(tally.rays)),
                          true});
    if (tally.rays == 0) continue;
    if (tally.right == tally.rays)
      right.push_back(label);
    else if (!tally.wrong && !tally.unexplained && !tally.not_given) {
      const double percent =
          100 * static_cast<double>(tally.rays - tally.right) / static_cast<double>(tally.rays);
      explained[percent < 0.1 ? fmt::format("{:.1g}", percent) : fmt::format("{:.1f}", percent)].push_back(
          label);
    }
  }
  std::string text;
  if (right.size() > 6) right = {fmt::format("{} structures", right.size())};
  if (!right.empty())
    text = fmt::format("{} gave the true primitive and every bit of t on every ray.", listed(right));
  for (auto& [percent, labels] : explained) {
    const bool one = labels.size() == 1;
    if (labels.size() > 6) labels = {fmt::format("{} others", labels.size())};
    text +=
        fmt::format("{}{} differ{} on {}% of {} rays, every time explained by rounding, a tie or an edge.",
                    text.empty() ? "" : " ", listed(labels), one ? "s" : "", percent, one ? "its" : "their");
  }
  if (!text.empty()) findings.push_back({"Answers", text});

  std::string noted;
  for (const auto& [spec, tally] : all.of)
    if (!tally.notes.empty())
      noted +=
          fmt::format("{}{}: {}", noted.empty() ? "" : "; ", report.specs[spec].label, *tally.notes.begin());
  if (!noted.empty()) findings.push_back({"Not as asked", noted + ". See the remarks."});
}

}  // namespace

std::string question(const Report& report) {
  std::set<std::string> scenes;
  for (const ReportSection& section : report.sections) scenes.insert(section.title);
  if (scenes.empty()) return "No records";
  return fmt::format("What traces {} fastest, and is every answer right?",
                     scenes.size() == 1 ? *scenes.begin() : fmt::format("these {} scenes", scenes.size()));
}

std::vector<Finding> verdict(const Report& report) {
  std::vector<Finding> findings;
  if (report.sections.empty()) return findings;
  const Tallies all = tallies(report);
  std::uint64_t rays = 0;
  for (const auto& [spec, tally] : all.of) rays += tally.rays;
  findings.push_back(fastest(report, all));
  if (Finding other = best_other(report, all); !other.text.empty()) findings.push_back(std::move(other));
  if (all.races) findings.push_back(how_sure(report, all));
  add_answers(findings, report, all);
  findings.push_back(
      {"Raced",
       fmt::format("{} on {} with {}: {}, {} answers checked.", counted(all.of.size(), "structure"),
                   counted(all.scenes.size(), "scene"), counted(report.batches.size(), "kind") + " of rays",
                   counted(all.races, "race"), grouped(rays))});
  return findings;
}

}  // namespace raymeter
