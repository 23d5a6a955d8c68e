#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace raymeter {

/// A hostile file and what must become of it.
struct HostileRow {
  std::string file;  ///< in tests/data/hostile, unless `make` makes it
  // Read: with so many primitives, of which so many of 16x16 primary rays and 256 random rays hit one.
  std::uint64_t primitives = 0, primary_hits = 0, random_hits = 0;
  const char* camera = nullptr;          ///< --camera, where the file's own (or the default one) sees nothing
  const char* embree_refuses = nullptr;  ///< what Embree alone can't take, and says so
  /// Refused: what follows the path in the message, as a regular expression.
  const char* refused = nullptr;
  bool unreadable = false;                                      ///< to all but root
  std::function<void(const std::filesystem::path&)> make = {};  ///< makes the file
};

/// How a failed test names its row.
inline std::ostream& operator<<(std::ostream& stream, const HostileRow& row) {
  return stream << row.file;
}

/// The table.
std::vector<HostileRow> hostile_rows();

}  // namespace raymeter
