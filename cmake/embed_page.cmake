# Puts the styles and scripts of the report into its page, and the page into a C++ source:
#   cmake -D FOLDER=reports/html -D CHART_JS=chart.min.js -D OUTPUT=page_template.cpp -P embed_page.cmake
file(READ ${FOLDER}/page.html page)
file(READ ${FOLDER}/style.css style)
file(READ ${CHART_JS} chart_js)
string(REGEX REPLACE "//# sourceMappingURL=[^\n]*" "" chart_js "${chart_js}")  # browsers would look for it
set(scripts "")
foreach(name format data draw bars lines figures filters page)
  file(READ ${FOLDER}/${name}.js script)
  string(APPEND scripts "${script}")
endforeach()
string(REPLACE "/*STYLE*/" "${style}" page "${page}")
string(REPLACE "/*CHART_JS*/" "${chart_js}" page "${page}")
string(REPLACE "/*SCRIPTS*/" "${scripts}" page "${page}")
if(page MATCHES "\\)page\"")
  message(FATAL_ERROR "the page holds the end of the C++ literal that it is put into")
endif()
file(WRITE ${OUTPUT} "#include \"reports/html/page_template.h\"

namespace raymeter {
const std::string_view page_template = R\"page(${page})page\";
}  // namespace raymeter
")
