#include "reports/text.h"

#include <algorithm>

namespace raymeter {

std::string wrapped(std::string_view head, std::string_view text, std::size_t indent) {
  std::string result, line(head);
  bool has_word = false;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (has_word && line.size() + 1 + word.size() > page_width) {
      result += line + "\n";
      line.assign(indent, ' ');
      has_word = false;
    }
    if (has_word) line += " ";
    line += word;
    has_word = true;
  }
  return result + line + "\n";
}

}  // namespace raymeter
