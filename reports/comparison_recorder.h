#pragma once
#include <cstddef>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "harness/comparison.h"
#include "reports/progress_bar.h"
#include "reports/record_files.h"

namespace raymeter {

/// Watches comparisons for a person: keeps the records for a table, shows progress on a terminal, writes to a
/// log and goes on from it, and knows whether all was right. A reference that is refuted is reported on
/// standard error.
class ComparisonRecorder : public ComparisonObserver {
 public:
  /// Both must outlive it. Without a log nothing is written, and everything is measured.
  explicit ComparisonRecorder(const Registry& registry, RecordLog* log = nullptr)
      : registry_(registry), log_(log) {}

  const Record* finished(std::string_view key) override;
  void record(const Record& record) override;
  void progress(std::size_t done, std::size_t total, std::string_view doing) override;
  void reference_refuted(std::string_view batch, std::size_t rays) override;

  /// The records since it was last asked, as of one scene; the next scene begins anew.
  std::vector<Record> take_records();
  /// Whether no record so far was a fault (is_fault) and no reference was refuted.
  bool all_right() const { return all_right_; }

 private:
  const Registry& registry_;
  RecordLog* log_;
  ProgressBar bar_;
  std::vector<Record> records_;
  bool all_right_ = true;
};

}  // namespace raymeter
