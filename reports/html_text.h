#pragma once
#include <string>
#include <string_view>

namespace raymeter {

/// Text as content or as a quoted attribute of HTML.
std::string html_text(std::string_view text);

/// JSON that may stand inside a <script>: no "<" is left in it.
std::string json_in_script(std::string json);

/// Base64 (RFC 4648), as data URIs need it.
std::string base64(std::string_view bytes);

}  // namespace raymeter
