#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_lines.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::number_table_test {
namespace {

const std::filesystem::path kFile = "t.csv";

TEST(CsvReader, GivesRowsAsCells) {
  CsvReader csv{LineReader("a,b\r\n 1 ,\t2\r\n,\n\n3,4"), kFile};
  EXPECT_EQ(csv.columns(), (Words{"a", "b"}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"1", "2"}));
  EXPECT_EQ(csv.line(), 2u);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"", ""}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"3", "4"}));
  EXPECT_EQ(csv.line(), 5u);
  EXPECT_FALSE(csv.next());
}

TEST(CsvReader, FindsTheHeaderAndItsSeparatorByExpectedNames) {
  const Words expected = {"a", "b"};
  for (const char* text :
       {"a,b\n1,2\n", "a;b\n1;2\n", "a\tb\n1\t2\n", " a   b \n 1\t 2\n", "\"a\",\"b\"\n\"1\", \"2\"\n", "a,b,\n1,2,\n",
        "a;b\n1;2;;\n", "# a,b\n1,2\n", "% a b\n1,2\n", "%a,b\n# other\n1,2\n", "# made by x, 3\n\na,b\n% units\n1,2\n",
        "a b\n1;2\n", "a,b\n1 2\n"}) {
    CsvReader csv(LineReader(text), kFile, expected);
    EXPECT_EQ(csv.columns(), expected) << text;
    ASSERT_TRUE(csv.next()) << text;
    EXPECT_EQ(csv.cells(), (Words{"1", "2"})) << text;
    EXPECT_FALSE(csv.next()) << text;
  }
}

const std::vector<TableQuantity> kQuantities = {{.alternatives = {{"t"}}},
                                                {.alternatives = {{"x", "y"}, {"r", "phi"}}},
                                                {.alternatives = {{"f"}}, .is_optional = true}};

NumberTable table_of(const std::string& text, std::size_t max_rows = 10) {
  return parse_number_table(text, kFile, kQuantities, max_rows);
}

std::string refusal_of(const std::string& text) {
  const auto error = test::input_error_of([&] { table_of(text); });
  return error ? error->what() : "";
}

TEST(NumberTable, FindsColumnsByNameInAnyOrder) {
  const NumberTable table = table_of("y,speed,t,x\n3,9,1,2\n");
  EXPECT_EQ(table.values, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(table.chosen, (std::vector<std::optional<std::size_t>>{0, 0, std::nullopt}));
  EXPECT_EQ(table.notes, std::vector<std::string>{"line 1: column 2 \"speed\" is not used"});
  EXPECT_EQ(table_of("f,phi,r,t\n4,3,2,1\n").values, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(table_of("t,x,y,a,b\n1,2,3,word,\n").notes,
            std::vector<std::string>{"line 1: columns 4 \"a\", 5 \"b\" are not used"});
  EXPECT_TRUE(table_of("t,x,y\n1,2,3\n").notes.empty());
}

TEST(NumberTable, IsRefusedWithoutAColumnOrWithAColumnTwice) {
  const std::string allowed = "; allowed: the columns t; x,y or r,phi; optionally f (in any order, others are ignored)";
  EXPECT_EQ(refusal_of("t,x,vx,vy\n"), "t.csv, line 1: got header \"t,x,vx,vy\"; missing: y" + allowed);
  EXPECT_EQ(refusal_of("\n# c\nt;f\n"), "t.csv, line 3: got header \"t,f\"; missing: x,y or r,phi" + allowed);
  EXPECT_EQ(refusal_of("0,1,2\n0,1,2\n").substr(0, 56), "t.csv, line 1: got a row of numbers and no header; allow");
  EXPECT_EQ(refusal_of("t,x,y,x\n"), "t.csv, line 1: columns 2 and 4 are both named \"x\"; allowed: each name once");
  EXPECT_EQ(refusal_of("t,x,y,r,phi\n"),
            "t.csv, line 1: has the columns x,y and the columns r,phi; allowed: only one of them");
}

TEST(NumberTable, MayHaveDecimalCommasBetweenOtherSeparators) {
  for (const char* text : {"t;x;y\n0;-1,5;2e-3\n0,25;+3;1,5e2\n", "t\tx\ty\n0\t-1,5\t2e-3\n0,25\t3\t150\n",
                           "t x y\n0 -1,5 2e-3\n0,25 3 150\n", "t,x,y\n0,\"-1,5\",2e-3\n\"0,25\",3,150\n"}) {
    const NumberTable table = table_of(text);
    EXPECT_EQ(table.values, (std::vector<double>{0, -1.5, 0.002, 0.25, 3, 150})) << text;
    EXPECT_EQ(table.notes, std::vector<std::string>{"line 2: numbers are read with a decimal comma"}) << text;
  }
  EXPECT_EQ(
      refusal_of("t,x,y\n0,0,1,0,2,0\n1,0,1,0,2,0\n"),
      "t.csv, line 2: got 6 cells; allowed: 3; a decimal comma splits a number: write a decimal point, or separate "
      "the columns by \";\" (1 more row has faults)");
  for (const char* mixed : {"t;x;y\n0;1,5;2.5\n", "t;x;y\n0;1.234,5;2\n", "t;x;y\n0;1,234,567;2\n"})
    EXPECT_NE(refusal_of(mixed).find("decimal comma"), std::string::npos) << refusal_of(mixed);
}

TEST(NumberTable, IsRefusedOnceWithTheFirstFaultAndTheNumberOfFaults) {
  EXPECT_EQ(
      refusal_of("t,x,y\n0,1,nan\n0,1,2\n0,,2\n0,1,NaN\n"),
      "t.csv, line 2: column 3 \"y\": got \"nan\"; allowed: a finite number; remove the row, or replace the missing "
      "value (2 more rows have faults)");
  EXPECT_EQ(refusal_of("# c\nt,x,y\n0,1,2\n\n0,1\n"),
            "t.csv, line 5: got 2 cells; allowed: 3; is the row incomplete, or the file cut off?");
  EXPECT_EQ(refusal_of("t,x,y\n0,1,2\n0;1;2\n"),
            "t.csv, line 3: got 1 cells; allowed: 3; the row is separated by \";\", the header by \",\"");
}

TEST(NumberTable, ReportsLinesAboveTheHeader) {
  for (const auto& [text, note] :
       {std::pair("My recording\nt,x,y\n1,2,3\n", "line 1: 1 line above the header is not used"),
        {"\nGroup,Tip,Tip\nmade by x\n\nt;x;y\n1;2;3\n", "line 2: 2 lines above the header are not used"},
        {"sep=;\nt;x;y\n1;2;3\n", ""}}) {
    const NumberTable table = table_of(text);
    EXPECT_EQ(table.values, (std::vector<double>{1, 2, 3})) << text;
    EXPECT_EQ(table.notes, note[0] == 0 ? std::vector<std::string>{} : std::vector<std::string>{note});
  }
  // A header below numbers is no header, and neither is a line with only one known name.
  EXPECT_NE(refusal_of("a,b,c\n1,2,3\nt,x,y\n").find("line 1: got header"), std::string::npos);
  EXPECT_NE(refusal_of("title\nx is what is meant\n1,2,3\n").find("line 1: got header"), std::string::npos);
  EXPECT_EQ(refusal_of("t,x,y\ns,m,m\n1,2,3\n"),
            "t.csv, line 2: column 1 \"t\": got \"s\"; allowed: a finite number; remove the line if it holds names or "
            "units");
}

TEST(NumberTable, KnowsTheLinesOfRows) {
  const NumberTable table = table_of("# c\n\nt,x,y\n0,0,0\n1,0,0\n\n% c\n2,0,0\n,,\n3,0,0\n4,0,0\n");
  ASSERT_EQ(table.rows(), 5u);
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < table.rows(); ++i) lines.push_back(table.line_of(i));
  EXPECT_EQ(lines, (std::vector<std::size_t>{4, 5, 8, 10, 11}));
}

TEST(NumberTable, ReportsALastLineThatMayBeCut) {
  const std::vector<std::string> cut = {"line 3, the last line, has no line end: is the file cut short?"};
  EXPECT_EQ(table_of("t,x,y\n0,0,0\n1,0,-0.0").notes, cut);
  EXPECT_EQ(table_of("t,x,y\r0,0,0\r1,0,0").notes, cut);
  EXPECT_TRUE(table_of("t,x,y\n0,0,0\n1,0,0\n").notes.empty());
}

TEST(NumberTable, MayHaveBlanksBlankLinesCarriageReturnsAndAsManyRowsAsAllowed) {
  const std::string text = "t,x,y\r\n\r\n 1 ,\t2,3\r\n  \n3,4,5";
  EXPECT_EQ(table_of(text, 2).values, (std::vector<double>{1, 2, 3, 3, 4, 5}));
  const auto error = test::input_error_of([&] { table_of(text, 1); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "t.csv, line 5: more than 1 rows");
}

}  // namespace
}  // namespace hapbench::number_table_test
