#include "cli/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

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

Report report_of(const std::vector<std::string>& folders, const Registry& registry) {
  std::vector<Record> records;
  Environments environments;
  for (const std::string& folder : folders) {
    std::ranges::move(records_in(folder), std::back_inserter(records));
    for (auto& environment : read_environments(std::filesystem::path(folder) / "environment.json"))
      if (std::ranges::find(environments, environment.first, &Environments::value_type::first) ==
          environments.end())
        environments.push_back(std::move(environment));
  }
  return make_report(records, std::move(environments), registry);
}

}  // namespace

void write_report_page(const std::filesystem::path& folder, const Registry& registry) {
  replace_file(folder / "report.html", report_page(report_of({folder.string()}, registry)));
}

int run_report(const ReportOptions& options, const Registry& registry) {
  const std::filesystem::path out = options.out.empty() ? "report.html" : options.out;
  const std::string form = out.extension().string();
  if (form == ".csv") {
    std::vector<Record> records;
    for (const std::string& folder : options.folders)
      std::ranges::move(records_in(folder), std::back_inserter(records));
    write_csv(out, records);
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
