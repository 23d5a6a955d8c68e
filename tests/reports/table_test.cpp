#include "reports/table.h"

#include <gtest/gtest.h>

namespace raymeter {
namespace {

Table example() {
  Table table;
  table.caption = "A | B";
  table.columns = {{"Name", "", false}, {"Time", "ms"}};
  table.rows = {{{{"a_b<c>"}, {"1.5", Mark::best}}},
                {{{"50% & \\x{y}"}, {"2", Mark::noisy}}, {}, {}, {}, true}};
  table.note = "Note.";
  return table;
}

TEST(Table, MarkdownEscapesWhatWouldBeMarkup) {
  EXPECT_EQ(markdown_table(example()),
            "**A \\| B**\n\n| Name | Time (ms) |\n|---|---:|\n| a\\_b&lt;c> | **1.5** |\n"
            "| 50% &amp; \\\\x{y} | 2 \\~ |\n\nNote.\n\n");
}

TEST(Table, LatexIsBooktabs) {
  EXPECT_EQ(latex_table(example()),
            R"(\begin{table}
  \centering
  \caption{A \textbar{} B}
  \begin{tabular}{lr}
    \toprule
    Name & Time (ms) \\
    \midrule
    a\_b\textless{}c\textgreater{} & \textbf{1.5} \\
    \addlinespace
    50\% \& \textbackslash{}x\{y\} & 2\rlap{\textasciitilde} \\
    \bottomrule
  \end{tabular}
  \par\smallskip\footnotesize Note.
\end{table}

)");
}

TEST(Table, TextStaysText) {
  EXPECT_EQ(latex_text("#1 $~^\"é--"),
            "\\#1 \\$\\textasciitilde{}\\textasciicircum{}\\textquotedbl{}é{-}{-}");
  EXPECT_EQ(markdown_text("[a](b) `c`\nd"), "\\[a\\](b) \\`c\\` d");
}

}  // namespace
}  // namespace raymeter
