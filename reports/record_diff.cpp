#include "reports/record_diff.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "reports/record_text.h"
#include "reports/text.h"

namespace raymeter {
namespace {

using Kind = Change::Kind;

/// What must be equal for two records to be of the same race.
using Race =
    std::tuple<std::string, std::string, std::string, std::string, std::string, Record::Count, Record::Count>;
Race race_of(const Record& r) {
  return {r.scene, r.batch, r.spec, r.baseline, r.order, r.threads, r.seed};
}

std::map<Race, const Record*> by_race(std::span<const Record> records) {
  std::map<Race, const Record*> result;
  for (const Record& record : records) result[race_of(record)] = &record;  // the last of a race counts
  return result;
}

std::string cpu_of(const Record& record, const Environments& environments) {
  for (const auto& [id, entries] : environments)
    if (id == record.environment_id)
      for (const auto& [name, value] : entries)
        if (name == "cpu") return value;
  return "";
}

/// "20.5 -> 21 (+2.4%)".
std::string arrow(double before, double after) {
  std::string text = fmt::format("{:.6g} -> {:.6g}", before, after);
  if (before != 0) text += fmt::format(" ({:+.2g}%)", 100 * (after / before - 1));
  return text;
}

/// Which way a number is worse when it rises.
enum class Rise : unsigned char { worse, better, neither };

class Comparer {
 public:
  Comparer(std::vector<Change>& changes, std::string race) : changes_(changes), race_(std::move(race)) {}

  void add(Kind kind, std::string what) { changes_.push_back({kind, race_, std::move(what)}); }

  template <class Optional>
  void exact(std::string_view name, const Optional& before, const Optional& after, Rise rise) {
    if (before == after) return;
    if (!before || !after) return add(Kind::other, fmt::format("{} {}", name, after ? "is new" : "is gone"));
    const bool rises = *after > *before;
    add(rise == Rise::neither            ? Kind::other
        : rises == (rise == Rise::worse) ? Kind::worse
                                         : Kind::better,
        fmt::format("{} {}", name, arrow(static_cast<double>(*before), static_cast<double>(*after))));
  }

 private:
  std::vector<Change>& changes_;
  std::string race_;
};

void compare_counts(Comparer& comparer, const Record& before, const Record& after) {
  constexpr std::array<std::pair<std::string_view, Rise>, 28> rises{{
      {"right", Rise::better},
      {"within_bound", Rise::neither},
      {"tie", Rise::neither},
      {"edge", Rise::neither},
      {"grazing", Rise::neither},
      {"at_limit", Rise::neither},
      {"degenerate", Rise::neither},
      {"wrong", Rise::worse},
      {"unexplained", Rise::worse},
      {"not_given", Rise::worse},
      {"steps_per_ray", Rise::worse},
      {"tests_per_ray", Rise::worse},
      {"test_blocks_per_ray", Rise::worse},
      {"distinct_tests_per_ray", Rise::worse},
      {"decides_per_ray", Rise::worse},
      {"point_locations_per_ray", Rise::worse},
      {"subgrids_entered_per_ray", Rise::worse},
      {"steps_max", Rise::worse},
      {"tests_max", Rise::worse},
      {"bytes", Rise::worse},
      {"peak_bytes", Rise::worse},
      {"cells", Rise::neither},
      {"references", Rise::neither},
      {"nx", Rise::neither},
      {"ny", Rise::neither},
      {"nz", Rise::neither},
      {"depth", Rise::neither},
      {"hits", Rise::neither},
  }};
  for (const auto& [name, rise] : rises) {
    const Column& column = *std::ranges::find(columns(), name, &Column::name);
    std::visit(
        [&, named = name, way = rise](auto member) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(before.*member)>, Record::Text>)
            comparer.exact(named, before.*member, after.*member, way);
        },
        column.member);
  }
  if (before.hit_hash != after.hit_hash)
    comparer.add(Kind::other,
                 fmt::format("hit_hash {} -> {}: other answers", before.hit_hash, after.hit_hash));
  if (before.note != after.note)
    comparer.add(Kind::other, fmt::format("note \"{}\" -> \"{}\"", before.note, after.note));
}

void compare_times(Comparer& comparer, const Record& before, const Record& after, double floor,
                   double tolerance) {
  if (before.ratio_low && before.ratio_high && after.ratio_low && after.ratio_high && before.ratio &&
      after.ratio) {
    const double factor = 1 + std::max(floor, tolerance);
    const bool slower = *after.ratio_high < *before.ratio_low && *after.ratio * factor < *before.ratio;
    const bool faster = *after.ratio_low > *before.ratio_high && *after.ratio > *before.ratio * factor;
    if (slower || faster)
      comparer.add(slower ? Kind::worse : Kind::better,
                   fmt::format("ratio {}, intervals {:.3g}..{:.3g} and {:.3g}..{:.3g}",
                               arrow(*before.ratio, *after.ratio), *before.ratio_low, *before.ratio_high,
                               *after.ratio_low, *after.ratio_high));
  }
}

void compare_builds(Comparer& comparer, const Record& before, const Record& after, double tolerance) {
  const auto is_whole = [](const Record& r) { return r.build_s && r.build_low_s && r.build_high_s; };
  if (!is_whole(before) || !is_whole(after)) return;
  const double factor = 1 + 4 * tolerance;
  const bool slower = *after.build_low_s > *before.build_high_s * factor;
  const bool faster = *after.build_high_s * factor < *before.build_low_s;
  if (slower || faster)
    comparer.add(slower ? Kind::worse : Kind::better, "build_s " + arrow(*before.build_s, *after.build_s));
}

/// How far the baseline strays from itself on the rays of each scene, in any of the records.
using Floors = std::map<std::pair<std::string, std::string>, double>;
void add_floors(Floors& floors, std::span<const Record> records) {
  for (const Record& r : records)
    if (r.spec == r.baseline && r.ratio && *r.ratio > 0) {
      double& floor = floors[{r.scene, r.batch}];
      floor = std::max(floor, std::max(*r.ratio, 1 / *r.ratio) - 1);
    }
}

}  // namespace

bool RecordDiff::worse() const {
  return std::ranges::any_of(changes, [](const Change& change) { return change.kind == Kind::worse; });
}

RecordDiff diff_records(std::span<const Record> before, std::span<const Record> after,
                        const Environments& environments, const Registry& registry, double tolerance) {
  RecordDiff diff;
  Floors floors;
  add_floors(floors, before);
  add_floors(floors, after);
  const auto old_races = by_race(before), new_races = by_race(after);
  const auto named = [&](const Record& r) {
    return fmt::format("{}  {}  {}", brief_scene(r.scene), brief_spec(r.spec, registry),
                       brief_batch(r.batch));
  };
  std::set<Race> done;
  std::set<std::pair<std::string, std::string>> built;
  // In the order of the records, not of the map.
  for (const Record& record : before) {
    const Race race = race_of(record);
    if (!done.insert(race).second) continue;
    const Record& old = *old_races.at(race);
    Comparer comparer(diff.changes, named(old));
    const auto found = new_races.find(race);
    if (found == new_races.end()) {
      comparer.add(Kind::worse, "is missing");
      continue;
    }
    const Record& now = *found->second;
    ++diff.compared;
    if (old.status != now.status) {
      comparer.add(
          now.status == "ok" ? Kind::better : Kind::worse,
          fmt::format("status {} -> {}{}", old.status, now.status, now.note.empty() ? "" : ": " + now.note));
      continue;
    }
    if (old.scene_hash != now.scene_hash || old.ray_hash != now.ray_hash) {
      comparer.add(Kind::worse, old.scene_hash != now.scene_hash
                                    ? "another scene of the same name: not compared"
                                    : "other rays: not compared");
      continue;
    }
    if (old.reference_hash != now.reference_hash)
      comparer.add(Kind::worse, fmt::format("reference_hash {} -> {}: another truth about the same rays",
                                            old.reference_hash, now.reference_hash));
    compare_counts(comparer, old, now);
    if (cpu_of(old, environments) != cpu_of(now, environments)) {
      diff.times_compared = false;
      continue;
    }
    compare_times(comparer, old, now, floors[{old.scene, old.batch}], tolerance);
    // A structure is built once for all rays.
    if (built.insert({old.scene, old.spec}).second) compare_builds(comparer, old, now, tolerance);
  }
  for (const Record& record : after)
    if (done.insert(race_of(record)).second) diff.changes.push_back({Kind::other, named(record), "is new"});
  return diff;
}

std::string diff_text(const RecordDiff& diff) {
  std::string text;
  constexpr std::pair<Kind, const char*> kinds[] = {
      {Kind::worse, "Worse"}, {Kind::better, "Better"}, {Kind::other, "Other"}};
  std::string summary;
  for (const auto& [kind, title] : kinds) {
    std::size_t count = 0;
    std::string race;
    for (const Change& change : diff.changes) {
      if (change.kind != kind) continue;
      if (count++ == 0) text += fmt::format("{}\n", title);
      if (change.race != race) text += wrapped("  ", change.race, 4);
      race = change.race;
      text += wrapped("    ", change.what, 6);
    }
    summary += fmt::format(", {} {}", count,
                           kind == Kind::worse    ? "worse"
                           : kind == Kind::better ? "better"
                                                  : "other changes");
  }
  if (!text.empty()) text += "\n";
  if (!diff.times_compared) text += "Times are not compared: the runs are of different processors.\n";
  return text + fmt::format("{} races compared{}\n", diff.compared, summary);
}

}  // namespace raymeter
