#pragma once
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "harness/record.h"

namespace raymeter {

/// records.jsonl: one JSON object a line, keys as the columns, absent values left out. Each record is on disk
/// as soon as `append` returns, so a killed run keeps all that it finished.
class RecordLog {
 public:
  /// Opens or creates the file, reads what it holds, and cuts off a last line that a killed run left
  /// unfinished. Throws Error (file, line) on anything else that is no record.
  explicit RecordLog(const std::filesystem::path& file);

  void append(const Record& record);
  std::span<const Record> records() const { return records_; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<Record> records_;
};

/// What a records.jsonl holds; a last line that was left unfinished is not read. Throws Error (file, line).
std::vector<Record> read_records(const std::filesystem::path& file);

/// records.csv (RFC 4180): a header line of column names, then a line a record. Throws Error when it can't be
/// written.
void write_csv(const std::filesystem::path& file, std::span<const Record> records);

/// environment.json: a JSON object with an entry for each environment that made records in this folder, by
/// its id; each is an object of names and texts, in order. Adds the entry or replaces the one of the same id,
/// and keeps the others. Throws Error when the file can't be written, or holds anything else.
void write_environment(const std::filesystem::path& file, const std::string& id,
                       std::span<const std::pair<std::string, std::string>> entries);

/// Environments by their ids, each (name, text) in order, as write_environment wrote them. None where there
/// is no such file; throws Error when it holds anything else.
using Environments = std::vector<std::pair<std::string, std::vector<std::pair<std::string, std::string>>>>;
Environments read_environments(const std::filesystem::path& file);

/// Writes beside the file and renames, so that a reader never sees half of it. Throws Error.
void replace_file(const std::filesystem::path& file, const std::string& content);

}  // namespace raymeter
