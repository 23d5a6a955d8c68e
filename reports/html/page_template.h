#pragma once
#include <string_view>

namespace raymeter {

/// page.html with the styles and scripts of this folder and Chart.js in it: cmake/embed_page.cmake makes it
/// when the library is built. Its places are <!--TITLE-->, <!--BODY--> and <!--DATA-->, once each, in this
/// order.
extern const std::string_view page_template;

}  // namespace raymeter
