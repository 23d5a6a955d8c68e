#include "reports/record_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scenes/base/atomic_file.h"
#include "scenes/base/error.h"

namespace raymeter {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Record& record) {
  Json object = Json::object();
  for (const Column& column : columns())
    std::visit(
        [&](auto pointer) {
          const auto& value = record.*pointer;
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Record::Text>) {
            if (!value.empty()) object[std::string(column.name)] = value;
          } else if (value) {
            object[std::string(column.name)] = *value;
          }
        },
        column.member);
  return object;
}

/// Throws Error, or Json's exception for what is no text.
Record from_json(const Json& object) {
  if (!object.is_object()) throw Error("no object");
  Record record;
  for (const Column& column : columns()) {
    const auto found = object.find(std::string(column.name));
    if (found == object.end()) continue;
    std::visit(
        [&](auto pointer) {
          auto& value = record.*pointer;
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, Record::Text>) {
            value = found->template get<std::string>();
          } else if constexpr (std::is_same_v<Value, Record::Count>) {
            if (!found->is_number_unsigned()) throw Error(fmt::format("column {}: not a count", column.name));
            value = found->template get<std::uint64_t>();
          } else {
            if (!found->is_number()) throw Error(fmt::format("column {}: not a number", column.name));
            value = found->template get<double>();
          }
        },
        column.member);
  }
  return record;
}

std::string quoted(std::string text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

/// The records of a file, and the bytes of their lines in `good`. Nothing where there is no file.
std::vector<Record> read_lines(const std::filesystem::path& file, std::uintmax_t& good) {
  std::vector<Record> records;
  std::ifstream in(file, std::ios::binary);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (in.eof()) break;  // no newline: the run was killed while it wrote this line
    good += line.size() + 1;
    try {
      records.push_back(from_json(Json::parse(line)));
    } catch (const std::exception& error) {
      throw error_at_line(file.string(), number, fmt::format("not a record ({})", error.what()));
    }
  }
  return records;
}

/// The object of objects in an environment file, empty where there is no file.
Json parse_environments(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return Json::object();
  std::ostringstream text;  // stays empty where the file can't be read
  text << std::ifstream(file, std::ios::binary).rdbuf();
  Json environments = Json::parse(text.str(), nullptr, false);
  const auto is_object = [](const Json& entry) { return entry.is_object(); };
  if (!environments.is_object() || !std::ranges::all_of(environments, is_object))
    throw Error(fmt::format("{}: not a JSON object of environments by their ids", file.string()));
  return environments;
}

}  // namespace

void replace_file(const std::filesystem::path& file, const std::string& content) {
  AtomicFile atomic(file);
  std::ofstream stream(atomic.temporary(), std::ios::binary);
  stream << content;
  stream.close();
  if (!stream) throw Error(fmt::format("{}: can't be written", file.string()));
  atomic.commit();
}

RecordLog::RecordLog(const std::filesystem::path& file) : file_(file) {
  std::uintmax_t good = 0;
  records_ = read_lines(file, good);
  if (std::filesystem::exists(file) && std::filesystem::file_size(file) != good)
    std::filesystem::resize_file(file, good);
  stream_.open(file, std::ios::binary | std::ios::app);
  if (!stream_) throw Error(fmt::format("{}: can't be written", file.string()));
}

void RecordLog::append(const Record& record) {
  stream_ << to_json(record).dump(-1, ' ', false, Json::error_handler_t::replace) << '\n' << std::flush;
  if (!stream_) throw Error(fmt::format("{}: can't be written", file_.string()));
  records_.push_back(record);
}

std::vector<Record> read_records(const std::filesystem::path& file) {
  if (!std::ifstream(file)) throw Error(fmt::format("{}: can't be read", file.string()));
  std::uintmax_t good = 0;
  return read_lines(file, good);
}

void write_csv(const std::filesystem::path& file, std::span<const Record> records) {
  std::ostringstream text;
  const char* separator = "";
  for (const Column& column : columns()) {
    text << separator << column.name;
    separator = ",";
  }
  text << '\n';
  for (const Record& record : records) {
    separator = "";
    for (const Column& column : columns()) {
      text << separator << quoted(column.text(record));
      separator = ",";
    }
    text << '\n';
  }
  replace_file(file, text.str());
}

void write_environment(const std::filesystem::path& file, const std::string& id,
                       std::span<const std::pair<std::string, std::string>> entries) {
  Json environments = parse_environments(file);
  Json& environment = environments[id] = Json::object();
  for (const auto& [name, value] : entries) environment[name] = value;
  replace_file(file, environments.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Environments read_environments(const std::filesystem::path& file) {
  Environments result;
  const Json environments = parse_environments(file);
  for (const auto& [id, entries] : environments.items()) {
    auto& environment = result.emplace_back(id, Environments::value_type::second_type{}).second;
    for (const auto& [name, value] : entries.items())
      environment.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return result;
}

}  // namespace raymeter
