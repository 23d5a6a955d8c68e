#include "reports/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "report_records.h"
#include "reports/html_text.h"
#include "reports/verdict.h"

namespace raymeter {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string hostile = "a\"b'</script><script>alert(1)</script>&é\xff.nff";

Report report_of(const std::vector<Record>& records) {
  return make_report(records, {{"e1", {{"cpu", "<b>&"}}}}, report_registry());
}

/// What stands between two texts in a page.
std::string between(const std::string& page, const std::string& begin, const std::string& end) {
  const std::size_t from = page.find(begin) + begin.size();
  return page.substr(from, page.find(end, from) - from);
}

TEST(HtmlText, EscapesAllThatIsMarkup) {
  EXPECT_EQ(html_text("<a href=\"x\">'&'</a>é"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;é");
  EXPECT_EQ(json_in_script(R"({"a":"</script><!--"})"), R"({"a":"\u003c/script>\u003c!--"})");
}

TEST(HtmlText, Base64) {
  const char* cases[][2] = {{"", ""},        {"f", "Zg=="},        {"fo", "Zm8="},
                            {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}, {"\xff\xfe\xfb", "//77"}};
  for (const auto& [bytes, text] : cases) EXPECT_EQ(base64(bytes), text);
}

TEST(ReportPage, ShowsPictures) {
  Report report = report_of(report_records({"a"}));
  report.sections[0].pictures = {{"picture", "foo"}, {"<steps>", "foob"}};
  const std::string page = report_page(report);
  EXPECT_THAT(page, HasSubstr("<img src=\"data:image/png;base64,Zm9v\" alt=\"a: picture\">"));
  EXPECT_THAT(page, HasSubstr("<h4>&lt;steps&gt;</h4><img src=\"data:image/png;base64,Zm9vYg==\""));
}

TEST(ReportPage, NamesAreTextWhateverIsInThem) {
  const std::string page = report_page(report_of(report_records({hostile})));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("a&quot;b&#39;&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;é"));
  EXPECT_THAT(page, HasSubstr("&lt;b&gt;&amp;"));
  const auto data = nlohmann::json::parse(between(page, "id=\"data\">", "</script>"));
  EXPECT_EQ(data["sections"][0]["title"], "a\"b'</script><script>alert(1)</script>&é\xef\xbf\xbd.nff");
}

TEST(ReportPage, IsOneFileThatFetchesNothing) {
  const std::string page = report_page(report_of(report_records({"a"})));
  for (const char* fetched : {" src=", "<link", "@import", "url(", "sourceMappingURL"})
    EXPECT_THAT(page, Not(HasSubstr(fetched))) << fetched;
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, HasSubstr("Released under the MIT License")) << "Chart.js's notice";
  for (const char* place : {"<!--TITLE-->", "<!--BODY-->", "<!--DATA-->", "/*STYLE*/", "/*SCRIPTS*/"})
    EXPECT_THAT(page, Not(HasSubstr(place)));
}

TEST(ReportPage, EveryChartHasItsNumbersWithoutScripts) {
  const std::string page = report_page(report_of(report_records({"a", "b"})));
  std::size_t figures = 0, at = 0;
  while ((at = page.find("<figure", at)) != std::string::npos) {
    const std::string figure = page.substr(at, page.find("</figure>", at) - at);
    EXPECT_THAT(figure, HasSubstr("<td"));
    ++figures;
    ++at;
  }
  EXPECT_EQ(figures, 1u + 2u * 4u);  // overview; ratio, break-even, work, sweep
  EXPECT_THAT(page, HasSubstr("0.294–0.306"));
}

TEST(ReportPage, SaysWhatWentWrong) {
  std::vector<Record> records = report_records({"a"});
  records[0].wrong = 3;
  records[0].right = *records[0].rays - 3;
  records[1].note = "clamped from 9x9x9 to 5x5x5";
  records[3].noisy = "yes";
  records[3].spread = 0.2;
  Record failed = report_record("a", "mine", "primary", 1);
  failed.status = "failed";
  failed.note = "needs 8 MB";
  failed.ratio = failed.ratio_low = failed.ratio_high = failed.mrays_per_s = failed.build_s = {};
  failed.right = failed.wrong = {};
  failed.steps_per_ray = {};
  records.push_back(failed);
  const Report report = report_of(records);
  for (const std::string& text : {report_page(report), report_markdown(report)}) {
    EXPECT_THAT(text, HasSubstr("3 WRONG"));
    EXPECT_THAT(text, HasSubstr("clamped from 9x9x9 to 5x5x5"));
    EXPECT_THAT(text, HasSubstr("needs 8 MB"));
    EXPECT_THAT(text, HasSubstr("octree: primary 20%"));
    EXPECT_THAT(text, HasSubstr("3 of 153,600 answers contradict brute force"));
  }
  EXPECT_THAT(report_latex(report), HasSubstr("\\textbf{3 WRONG}"));
}

TEST(ReportPage, OfNoRecordsIsAPage) {
  EXPECT_THAT(report_page(report_of({})), HasSubstr("No records"));
  EXPECT_THAT(report_markdown(report_of({})), HasSubstr("No records"));
  report_latex(report_of({}));
}

TEST(ReportPage, OfFiveHundredRecordsStaysSmall) {
  std::vector<std::string> scenes;
  for (int i = 0; i < 50; ++i) scenes.push_back("scene-" + std::to_string(i));
  const auto records = report_records(scenes);
  ASSERT_EQ(records.size(), 500u);
  EXPECT_LT(report_page(report_of(records)).size(), 5'000'000u);
}

TEST(Verdict, IsPlainNumbers) {
  const Report report = report_of(report_records({"a", "b"}));
  EXPECT_EQ(question(report), "What traces these 2 scenes fastest, and is every answer right?");
  const std::vector<Finding> findings = verdict(report);
  EXPECT_EQ(findings[0].text, "embree on all 4 sets of rays.");
  EXPECT_THAT(findings[1].text, HasSubstr("grid traces at 0.300 of the throughput of embree"));
  EXPECT_THAT(findings[2].text, HasSubstr("none of 20 races is noisy"));
  EXPECT_THAT(findings[3].text,
              HasSubstr("grid:amount=0.5, grid, grid:amount=2 and octree gave the true primitive"));
  EXPECT_THAT(findings[3].text, HasSubstr("embree differs on 1.0% of its rays"));
  for (const Finding& finding : findings) EXPECT_FALSE(finding.fault);
}

}  // namespace
}  // namespace raymeter
