#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenarios/program/table_format.hpp"

/// Tests tables as Markdown, LaTeX and CSV. tests/scripts/table_test.py compiles the LaTeX.
namespace hapbench::table_format_test {
namespace {

std::string formatted(const Table& table, const char* format) {
  return formatted_tables(std::vector{table}, format);
}

/// Returns a table with two-line heads, errors, missing values, bounds, texts among the numbers and very small numbers.
Table every_kind() {
  return {{{"law", false}, {"largest\nforce [N]"}, {"published", true, "", "N/m"}, {"depth", true, "", "m"}, {"rank"}},
          {{"a_b", "1.25 +- 0.05", "1440", "7.3e-05", "1"},
           {"c|d", "12.5 +- 0.5", "-", "<= 0.0004", "-"},
           {"[soft]", "-3.00 +- 0.25", "none", "2.5e-06", "2"}},
          "runs of x"};
}

TEST(TableFormat, Markdown) {
  EXPECT_EQ(formatted(every_kind(), "markdown"),
            "| law | largest force \\[N\\] | published \\[N/m\\] | depth \\[m\\] | rank |\n"
            "| --- | ---: | ---: | ---: | ---: |\n"
            "| a_b | 1.25 ± 0.05 | 1440 | 7.3e-05 | 1 |\n"
            "| c\\|d | 12.5 ± 0.5 | - | ≤ 0.0004 | - |\n"
            "| \\[soft\\] | -3.00 ± 0.25 | none | 2.5e-06 | 2 |\n");
}

TEST(TableFormat, Csv) {
  EXPECT_EQ(formatted(every_kind(), "csv"),
            "law,largest force [N],largest force [N] +-,published [N/m],depth [m],rank\n"
            "a_b,1.25,0.05,1440,7.3e-05,1\n"
            "c|d,12.5,0.5,,<= 0.0004,\n"
            "[soft],-3.00,0.25,none,2.5e-06,2\n");
}

TEST(TableFormat, Latex) {
  EXPECT_EQ(formatted(every_kind(), "latex"),
            "% runs of x\n"
            "\\begin{tabular}{l S[separate-uncertainty=true,retain-zero-uncertainty=true,table-align-uncertainty=false,"
            "table-format=2.2(2)] S[table-format=4.0] S[table-format=1.1e-2] "
            "S[table-format=1.0]}\n"
            "  \\toprule\n"
            "  {} & {largest} & {} & {} & {} \\\\\n"
            "  {law} & {force [N]} & {published [N/m]} & {depth [m]} & {rank} \\\\\n"
            "  \\midrule\n"
            "  {a\\_b} & 1.25 +- 0.05 & 1440 & 7.3e-5 & 1 \\\\\n"
            "  {c\\textbar{}d} & 12.5 +- 0.5 & {--} & {$\\leq$ 0.0004} & {--} \\\\\n"
            "  {[soft]} & -3.00 +- 0.25 & {none} & 2.5e-6 & 2 \\\\\n"
            "  \\bottomrule\n"
            "\\end{tabular}\n");
}

/// Checks that special characters are escaped, and that the surrounding text is unchanged.
TEST(TableFormat, EscapesEverySpecialCharacter) {
  const Table table{{{"name", false}}, {{"a\\b{c}_d%e&f#g$h~i^j<k>l|m\"n--o\np"}}, "50 % of\nit"};
  EXPECT_NE(formatted(table, "latex")
                .find("{a\\textbackslash{}b\\{c\\}\\_d\\%e\\&f\\#g\\$h\\textasciitilde{}i\\textasciicircum{}j"
                      "\\textless{}k\\textgreater{}l\\textbar{}m{''}n-{}-o p}"),
            std::string::npos)
      << formatted(table, "latex");
  EXPECT_EQ(formatted(table, "latex").find("% 50 % of it\n\\begin"), 0u) << "a comment of one line";
  EXPECT_EQ(formatted(table, "markdown"),
            "| name |\n| --- |\n"
            "| a\\\\b{c}\\_d%e\\&f\\#g\\$h\\~i^j\\<k\\>l\\|m\"n--o p |\n");
  EXPECT_EQ(formatted({{{"name", false}}, {{"a,\"b\""}, {"=1+2"}}}, "csv"), "name\n\"a,\"\"b\"\"\"\n'=1+2\n")
      << "as in the result files";
}

TEST(TableFormat, EscapesUnderscoresThatBeginOrEndAWord) {
  EXPECT_NE(formatted({{{"name", false}}, {{"_a_ b_c _"}}}, "markdown").find("| \\_a\\_ b_c \\_ |"), std::string::npos);
}

/// Checks the exponent in LaTeX: siunitx reads one exponent, after number and error.
TEST(TableFormat, NumberAndErrorShareAnExponent) {
  const Table table{{{"v"}}, {{"7.35e-06 +- 1.2e-07"}, {"1.5e-05 +- 2e-06"}, {"3 +- 0.25"}}};
  const std::string latex = formatted(table, "latex");
  for (const char* number : {"  7.35 +- 0.12e-6 ", "  1.5 +- 0.2e-5 ", "  3.00 +- 0.25 "})
    EXPECT_NE(latex.find(number), std::string::npos) << number << latex;
}

TEST(TableFormat, HeadsHaveTheUnitOnce) {
  const auto head = [](const char* title, const char* unit) { return Table::Column{title, true, "", unit}.head(); };
  EXPECT_EQ(head("force", "N"), "force [N]");
  EXPECT_EQ(head("largest\nforce [N]", "N"), "largest force [N]");
  EXPECT_EQ(head("p50 us", "us"), "p50 us");
  EXPECT_EQ(head("rank", "1"), "rank");
  EXPECT_EQ(head("name", ""), "name");
  EXPECT_EQ(head("non-\nmonotonic", "1"), "non-monotonic");
}

TEST(TableFormat, SeveralTablesHaveCaptions) {
  const std::vector<Table> tables = {{{{"a"}}, {{"1"}}, "one_"}, {{{"b"}}, {{"2"}}, "two"}};
  EXPECT_EQ(formatted_tables(tables, "markdown"),
            "**one\\_**\n\n| a |\n| ---: |\n| 1 |\n\n**two**\n\n| b |\n| ---: |\n| 2 |\n");
  EXPECT_EQ(formatted_tables(tables, "csv"), "a\n1\n\nb\n2\n");
}

/// Checks that a column whose cells are texts is aligned like numbers, and not read by siunitx, and that long texts are
/// wrapped.
TEST(TableFormat, ColumnsOfTextAreNoNumbers) {
  const Table table{{{"value"}, {"text", false}}, {{"explicit", std::string(41, 'x')}, {"-", "-"}}};
  EXPECT_NE(formatted(table, "latex").find("{r >{\\raggedright\\arraybackslash}p{0.4\\linewidth}}"), std::string::npos);
  EXPECT_NE(formatted({{{"id", false}}, {{"12"}}}, "latex").find("\\begin{tabular}{l}"), std::string::npos)
      << "a text stays one if it looks like a number";
}

}  // namespace
}  // namespace hapbench::table_format_test
