#pragma once
#include <string>
#include <string_view>

namespace raymeter {

/// Appends a remark to those already in `note`; "; " stands between them.
inline void add_note(std::string& note, std::string_view text) {
  if (!note.empty()) note += "; ";
  note += text;
}

}  // namespace raymeter
