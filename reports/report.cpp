#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "reports/record_text.h"

namespace raymeter {
namespace {

/// Places in the palette of reports/html/style.css. The same structure has the same colour in every report,
/// so the known ones have fixed places; others get the free ones in order of their names.
constexpr std::array<std::string_view, 8> known_structures = {
    "embree", "grid", "tunable-grid", "octree", "two-level-grid", "counted-bvh", "brick-grid", "brute-force"};
constexpr std::size_t palette_size = 12;

void give_colours(std::vector<ReportSpec>& specs) {
  std::map<std::string, std::size_t> others;
  for (const ReportSpec& spec : specs)
    if (std::ranges::find(known_structures, spec.structure) == known_structures.end())
      others[spec.structure] = 0;
  std::size_t next = 0;
  for (auto& [name, colour] : others)
    colour = known_structures.size() + next++ % (palette_size - known_structures.size());
  for (ReportSpec& spec : specs) {
    const auto* const known = std::ranges::find(known_structures, spec.structure);
    spec.colour = known == known_structures.end()
                      ? others[spec.structure]
                      : static_cast<std::size_t>(known - known_structures.begin());
  }
}

/// The index of the element whose `canonical` is the given one; a new one is made by `make`.
template <class Element, class Make>
std::size_t index_of(std::vector<Element>& elements, const std::string& canonical, const Make& make) {
  const auto found = std::ranges::find(elements, canonical, &Element::canonical);
  if (found != elements.end()) return static_cast<std::size_t>(found - elements.begin());
  elements.push_back(make());
  return elements.size() - 1;
}

void add_once(std::vector<std::size_t>& indices, std::size_t index) {
  if (std::ranges::find(indices, index) == indices.end()) indices.push_back(index);
}

std::string count_or_unknown(const Record::Count& count) {
  return count ? fmt::format("{}", *count) : "unknown";
}

/// (name, value) of what must be equal for records to stand in one table.
std::vector<std::pair<std::string, std::string>> setting_of(const Record& record,
                                                            const Environments& environments) {
  const auto known = std::ranges::find(environments, record.environment_id, &Environments::value_type::first);
  return {{"scene hash", record.scene_hash},
          {"baseline", record.baseline},
          {"threads", count_or_unknown(record.threads)},
          {"order", record.order},
          {"seed", count_or_unknown(record.seed)},
          {"environment", known == environments.end() ? record.environment_id
                                                      : fmt::format("{}", known - environments.begin() + 1)}};
}

}  // namespace

const Record* ReportSection::find(std::size_t spec, std::size_t batch) const {
  for (std::size_t i = 0; i < records.size(); ++i)
    if (spec_of[i] == spec && batch_of[i] == batch) return &records[i];
  return nullptr;
}

Report make_report(std::span<const Record> records, Environments environments, const Registry& registry) {
  Report report;
  report.environments = std::move(environments);
  const auto spec_index = [&](const std::string& canonical) {
    return index_of(report.specs, canonical, [&] {
      return ReportSpec{canonical, brief_spec(canonical, registry), canonical.substr(0, canonical.find(':')),
                        0};
    });
  };

  std::vector<std::vector<std::pair<std::string, std::string>>> settings;  // of the sections
  for (const Record& record : records) {
    const std::size_t spec = spec_index(record.spec);
    const std::size_t batch = index_of(report.batches, record.batch,
                                       [&] { return ReportBatch{record.batch, brief_batch(record.batch)}; });
    const auto setting = setting_of(record, report.environments);
    // The first section of this scene and setting that has no other record of the same structure and rays.
    std::size_t at = 0;
    bool replaced = false;
    for (; at < report.sections.size(); ++at) {
      ReportSection& section = report.sections[at];
      if (section.scene != record.scene || settings[at] != setting) continue;
      const auto* earlier = section.find(spec, batch);
      if (!earlier) break;
      if (!record.key.empty() && earlier->key == record.key) {
        section.records[static_cast<std::size_t>(earlier - section.records.data())] = record;
        replaced = true;
        break;
      }
    }
    if (replaced) continue;
    if (at == report.sections.size()) {
      report.sections.push_back({record.scene, brief_scene(record.scene), "", 0, {}, {}, {}, {}, {}, {}});
      settings.push_back(setting);
    }
    ReportSection& section = report.sections[at];
    section.records.push_back(record);
    section.spec_of.push_back(spec);
    section.batch_of.push_back(batch);
    add_once(section.specs, spec);
    add_once(section.batches, batch);
  }

  for (ReportSection& section : report.sections) section.baseline = spec_index(section.records[0].baseline);
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    std::string& text = report.sections[i].setting;
    std::size_t same = 0;  // earlier sections of the same scene and setting
    for (std::size_t field = 0; field < settings[i].size(); ++field)
      for (std::size_t j = 0; j < report.sections.size(); ++j)
        if (report.sections[j].scene == report.sections[i].scene &&
            settings[j][field] != settings[i][field]) {
          text += fmt::format("{}{} {}", text.empty() ? "" : ", ", settings[i][field].first,
                              settings[i][field].second);
          break;
        }
    for (std::size_t j = 0; j < i; ++j)
      if (report.sections[j].scene == report.sections[i].scene && settings[j] == settings[i]) ++same;
    if (same) text += fmt::format("{}run {}", text.empty() ? "" : ", ", same + 1);
  }
  give_colours(report.specs);
  return report;
}

std::optional<Ratio> mean_ratio(const ReportSection& section, std::size_t spec) {
  Ratio logs;
  for (const std::size_t batch : section.batches) {
    const Record* record = section.find(spec, batch);
    if (record && record->rays == 0) continue;  // nothing to time, for anybody
    if (!record || !record->ratio || !(*record->ratio > 0)) return {};
    logs.value += std::log(*record->ratio);
    logs.low += std::log(record->ratio_low.value_or(*record->ratio));
    logs.high += std::log(record->ratio_high.value_or(*record->ratio));
    ++logs.races;
  }
  if (logs.races == 0) return {};
  const auto mean = [&](double sum) { return std::exp(sum / static_cast<double>(logs.races)); };
  return Ratio{mean(logs.value), mean(logs.low), mean(logs.high), logs.races};
}

const Record* envelope(const Report& report, const ReportSection& section, std::size_t batch) {
  const Record* best = nullptr;
  std::size_t rivals = 0;
  for (const std::size_t spec : section.specs) {
    if (report.specs[spec].structure != report.specs[section.baseline].structure) continue;
    const Record* record = section.find(spec, batch);
    if (!record || !record->ratio) continue;
    ++rivals;
    if (!best || *record->ratio > *best->ratio) best = record;
  }
  return rivals > 1 ? best : nullptr;
}

}  // namespace raymeter
