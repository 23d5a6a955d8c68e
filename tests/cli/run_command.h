#pragma once
// Runs the command as a user would, and reads what it wrote.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace raymeter {

struct Outcome {
  int status = -1;
  std::string text;  ///< standard output and standard error
};

/// Standard input is empty.
inline Outcome run(const std::string& arguments, const std::string& command = RAYMETER_COMMAND) {
  Outcome outcome;
  FILE* pipe = popen((command + " " + arguments + " 2>&1 </dev/null").c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

inline std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The fields of a line of RFC 4180.
inline std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      result.back() += line[++i];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      result.emplace_back();
    else
      result.back() += line[i];
  }
  return result;
}

using CsvRow = std::map<std::string, std::string>;

/// records.csv as rows by column name.
inline std::vector<CsvRow> read_csv(const std::filesystem::path& path) {
  const auto lines = lines_of(content(path));
  std::vector<CsvRow> rows;
  if (lines.empty()) return rows;
  const auto names = fields(lines[0]);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto values = fields(lines[i]);
    EXPECT_EQ(values.size(), names.size()) << lines[i];
    CsvRow& row = rows.emplace_back();
    for (std::size_t j = 0; j < std::min(names.size(), values.size()); ++j) row[names[j]] = values[j];
  }
  return rows;
}

}  // namespace raymeter
