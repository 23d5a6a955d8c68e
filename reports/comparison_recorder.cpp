#include "reports/comparison_recorder.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace raymeter {

const Record* ComparisonRecorder::finished(std::string_view key) {
  if (!log_) return nullptr;
  for (const Record& record : log_->records())
    if (record.key == key) return &record;
  return nullptr;
}

void ComparisonRecorder::record(const Record& record) {
  if (log_ && !finished(record.key)) log_->append(record);
  if (is_fault(record, registry_.find(record.structure))) all_right_ = false;
  records_.push_back(record);
}

void ComparisonRecorder::progress(std::size_t done, std::size_t total, std::string_view doing) {
  bar_.show(done, total, doing);
}

void ComparisonRecorder::reference_refuted(std::string_view batch, std::size_t rays) {
  all_right_ = false;
  bar_.clear();
  fmt::print(stderr, "raymeter: {}: brute force refutes the reference hits on {} rays; please report this\n",
             batch, rays);
}

std::vector<Record> ComparisonRecorder::take_records() {
  bar_.clear();
  return std::exchange(records_, {});
}

}  // namespace raymeter
