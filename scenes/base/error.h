#pragma once
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raymeter {

/// Something the user gave us can't be used: a file, a name, a parameter. The message is one line that
/// says what and where, fit to be printed after "raymeter: ". The command exits with status 2 on it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An Error in a text file, as "FILE:LINE: WHAT". `line` counts from 1.
Error error_at_line(std::string_view file, std::size_t line, std::string_view what);

/// An Error in a binary file, as "FILE: at byte OFFSET: WHAT".
Error error_at_byte(std::string_view file, std::size_t offset, std::string_view what);

}  // namespace raymeter
