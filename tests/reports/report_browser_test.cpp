// The report in a browser: charts, hover, filters, themes, paper; no errors, and nothing fetched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "report_records.h"
#include "reports/report_page.h"

namespace raymeter {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

void insert(std::string& page, const std::string& before, const std::string& text, bool last = false) {
  const std::size_t at = last ? page.rfind(before) : page.find(before);
  ASSERT_NE(at, std::string::npos) << before;
  page.insert(at, text);
}

/// What Chromium prints of a page after its scripts have run: the document, and its log.
std::string dump(const std::filesystem::path& file, const std::string& options) {
  const std::string profile = file.string() + ".profile";
  const std::string command =
      "timeout 100 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage"
      " --user-data-dir=" +
      profile +
      " --host-resolver-rules='MAP * ~NOTFOUND'"
      " --enable-logging=stderr --virtual-time-budget=20000 " +
      options + " --dump-dom file://" + file.string() + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c; (c = fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  pclose(pipe);
  std::filesystem::remove_all(profile);
  return text;
}

class ReportBrowserSlow : public testing::TestWithParam<const char*> {};

TEST_P(ReportBrowserSlow, WorksAsAPersonUsesIt) {
  if (std::system("command -v chromium >/dev/null") != 0)
    GTEST_SKIP() << "no chromium: script/setup test installs it";
  std::vector<Record> records = report_records({"a\"</script><script>alerted = 1</script>é", "b"});
  records[3].noisy = "yes";
  records[3].spread = 0.2;
  records[10].status = "failed";
  records[10].note = "needs 8 MB";
  records[10].ratio = records[10].ratio_low = records[10].ratio_high = records[10].mrays_per_s = {};
  std::string page = report_page(make_report(records, {{"e1", {{"cpu", "a"}}}}, report_registry()));
  insert(page, "<title>", R"(<script>
const pageErrors = [];
addEventListener("error", (event) => pageErrors.push(`error: ${event.message}`));
addEventListener("unhandledrejection", (event) => pageErrors.push(`rejected: ${event.reason}`));
addEventListener("securitypolicyviolation", (event) => pageErrors.push(`fetched: ${event.blockedURI}`));
for (const level of ["error", "warn"]) console[level] = (...what) => pageErrors.push(`console: ${what.join(" ")}`);
</script>)");
  insert(page, "</body>", "<script>" + content(RAYMETER_TEST_DATA "/report_exercise.js") + "</script>", true);
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) /
                                     (std::string("report_") + std::to_string(getpid()) + ".html");
  std::ofstream(file, std::ios::binary) << page;
  const std::string outcome = dump(file, GetParam());
  std::filesystem::remove(file);
  const std::size_t at = outcome.find("<pre id=\"outcome\">");
  ASSERT_NE(at, std::string::npos) << "the page's scripts did not run to their end:\n"
                                   << outcome.substr(0, 3000);
  const std::string said = outcome.substr(at, outcome.find("</pre>", at) - at);
  EXPECT_THAT(said, testing::HasSubstr("checks passed"));
  EXPECT_THAT(outcome, testing::Not(testing::HasSubstr(":CONSOLE")));
}

INSTANTIATE_TEST_SUITE_P(Widths, ReportBrowserSlow,
                         testing::Values("--window-size=1280,900", "--window-size=390,844"),
                         [](const auto& test) { return test.index == 0 ? "Laptop" : "Phone"; });

}  // namespace
}  // namespace raymeter
