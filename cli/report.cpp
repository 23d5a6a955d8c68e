#include "cli/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "cli/pictures.h"
#include "reports/record_diff.h"
#include "reports/record_files.h"
#include "reports/report.h"
#include "reports/report_page.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

std::vector<Record> records_in(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "records.jsonl";
  if (!std::filesystem::is_regular_file(file))
    throw Error(fmt::format("{}: no records.jsonl in it; is it the --out of a comparison?", folder.string()));
  return read_records(file);
}

Environments environments_in(const std::vector<std::string>& folders) {
  Environments environments;
  for (const std::string& folder : folders)
    for (auto& environment : read_environments(std::filesystem::path(folder) / "environment.json"))
      if (std::ranges::find(environments, environment.first, &Environments::value_type::first) ==
          environments.end())
        environments.push_back(std::move(environment));
  return environments;
}

std::vector<Record> all_records(const std::vector<std::string>& folders) {
  std::vector<Record> records;
  for (const std::string& folder : folders)
    std::ranges::move(records_in(folder), std::back_inserter(records));
  return records;
}

/// The pictures that stand beside the records (compare --pictures): of each scene the first that is found.
void add_pictures(Report& report, const std::vector<std::string>& folders) {
  // A megabyte each: those that say most.
  constexpr std::pair<const char*, const char*> names[] = {{"picture", "picture"},
                                                           {"heat-steps", "Steps of a pixel's rays"},
                                                           {"heat-tests", "Tests of a pixel's rays"}};
  for (ReportSection& section : report.sections)
    for (const auto& [name, title] : names)
      for (const std::string& folder : folders) {
        const std::filesystem::path file = std::filesystem::path(folder) /
                                           picture_folder(section.scene, section.records[0].scene_hash) /
                                           (std::string(name) + ".png");
        std::ifstream in(file, std::ios::binary);
        if (!in || !std::filesystem::is_regular_file(file)) continue;
        section.pictures.push_back({title, std::string(std::istreambuf_iterator<char>(in), {})});
        break;
      }
}

Report report_of(const std::vector<std::string>& folders, const Registry& registry) {
  Report report = make_report(all_records(folders), environments_in(folders), registry);
  add_pictures(report, folders);
  return report;
}

int run_diff(const ReportOptions& options, const Registry& registry) {
  if (options.folders.size() != 2 || !options.out.empty())
    throw Error("report --diff takes two folders, the old and the new one, and no -o");
  const RecordDiff diff = diff_records(records_in(options.folders[0]), records_in(options.folders[1]),
                                       environments_in(options.folders), registry, options.tolerance / 100);
  fmt::print("{}", diff_text(diff));
  return diff.worse() ? 1 : 0;
}

}  // namespace

void write_report_page(const std::filesystem::path& folder, const Registry& registry) {
  replace_file(folder / "report.html", report_page(report_of({folder.string()}, registry)));
}

int run_report(const ReportOptions& options, const Registry& registry) {
  if (options.diff) return run_diff(options, registry);
  const std::filesystem::path out = options.out.empty() ? "report.html" : options.out;
  const std::string form = out.extension().string();
  if (form == ".csv") {
    write_csv(out, all_records(options.folders));
  } else if (form == ".html" || form == ".md" || form == ".tex") {
    const Report report = report_of(options.folders, registry);
    replace_file(out, form == ".html" ? report_page(report)
                      : form == ".md" ? report_markdown(report)
                                      : report_latex(report));
  } else {
    throw Error(fmt::format("{}: expected a name that ends in .html, .md, .tex or .csv", out.string()));
  }
  fmt::print("{}\n", out.string());
  return 0;
}

}  // namespace raymeter
