#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace raymeter {

/// Columns of a line of printed text.
inline constexpr std::size_t page_width = 100;

/// `head` and `text` in lines that fit the page, each ended by a newline. `head` stays as it is; `text` is
/// broken between words, and its further lines are indented by `indent`. A longer word sticks out.
std::string wrapped(std::string_view head, std::string_view text, std::size_t indent);

}  // namespace raymeter
