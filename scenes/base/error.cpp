#include "scenes/base/error.h"

#include <fmt/format.h>

namespace raymeter {

Error error_at_line(std::string_view file, std::size_t line, std::string_view what) {
  return Error(fmt::format("{}:{}: {}", file, line, what));
}

Error error_at_byte(std::string_view file, std::size_t offset, std::string_view what) {
  return Error(fmt::format("{}: at byte {}: {}", file, offset, what));
}

}  // namespace raymeter
