#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/record.h"
#include "reports/record_files.h"

namespace raymeter {

/// A structure with its parameters, as the report shows it.
struct ReportSpec {
  std::string canonical, label, structure;
  std::size_t colour = 0;  ///< of the page's palette: the same for all specs of a structure
};

/// A ray kind as the report shows it.
struct ReportBatch {
  std::string canonical, label;
};

/// A PNG file that the report shows.
struct ReportPicture {
  std::string title;
  std::string png;  ///< its bytes
};

/// The records of one scene under one setting (machine, threads, order of rays, seed, baseline).
struct ReportSection {
  std::string scene;    ///< as the records name it
  std::string title;    ///< the same without what is at its default
  std::string setting;  ///< what tells it from other sections of the same scene; mostly empty
  std::size_t baseline = 0;
  std::vector<std::size_t> specs, batches;  ///< indices into the report's, in order of appearance
  std::vector<Record> records;
  std::vector<ReportPicture> pictures;
  std::vector<std::size_t> spec_of, batch_of;  ///< of each record

  const Record* find(std::size_t spec, std::size_t batch) const;  ///< nullptr: not measured
};

/// Records ordered for people to see, whichever form it is written in.
struct Report {
  std::vector<ReportSpec> specs;
  std::vector<ReportBatch> batches;
  std::vector<ReportSection> sections;
  Environments environments;
};

/// Of two records with the same key the later one counts. The registry shortens the specs that it knows.
Report make_report(std::span<const Record> records, Environments environments, const Registry& registry);

/// A ratio to the baseline with its interval, of one race or of several together.
struct Ratio {
  double value = 0, low = 0, high = 0;
  std::size_t races = 0;
};

/// The geometric mean over the batches of a section; the ends of its interval are those of the intervals, a
/// single race without one counting as it stands. Nothing where a batch has no ratio.
std::optional<Ratio> mean_ratio(const ReportSection& section, std::size_t spec);

/// The fastest of the baseline's own kind (another ISA, packets, build quality): what the baseline can do at
/// its best. Nothing where only one spec of that kind was raced.
const Record* envelope(const Report& report, const ReportSection& section, std::size_t batch);

}  // namespace raymeter
