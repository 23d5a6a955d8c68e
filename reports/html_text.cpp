#include "reports/html_text.h"

namespace raymeter {

std::string html_text(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string json_in_script(std::string json) {
  // In JSON a "<" stands only within strings, where it may be written as its number.
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; ++at)
    json.replace(at, 1, "\\u003c");
  return json;
}

}  // namespace raymeter
