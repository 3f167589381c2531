#include "scenarios/program/table.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace hapbench::table_test {
namespace {

TEST(Table, AlignsWordsLeftAndNumbersRightUnderTheirTitles) {
  Table table({{"name", false}, {"n"}, {"unit", false}});
  table.add({"a", "1", "m"});
  table.add({"longer", "1000", ""});
  EXPECT_EQ(table.text(),
            "name       n  unit\n"
            "------  ----  ----\n"
            "a          1  m\n"
            "longer  1000\n");
}

TEST(Table, TakesTitlesOfTwoLinesAndANarrowGap) {
  Table table({{"name", false}, {"force\nN"}, {"n"}}, 1);
  table.add({"a", "1", "2"});
  EXPECT_EQ(table.text(),
            "     force\n"
            "name     N n\n"
            "---- ----- -\n"
            "a        1 2\n");
}

TEST(Wrapped, BreaksBetweenWordsAndNeverWithinOne) {
  EXPECT_EQ(wrapped("aa bb cc", 1, 6), " aa bb\n cc\n");
  EXPECT_EQ(wrapped("aaaaaaaaaa b", 2, 6), "  aaaaaaaaaa\n  b\n");
  EXPECT_EQ(wrapped("a", 0, 6), "a\n");
  EXPECT_EQ(wrapped("aa bb", 2, std::string::npos), "  aa bb\n") << "a width without bound";
  EXPECT_EQ(wrapped("a\nb\n\nc", 1, 6), " a\n b\n\n c\n");
}

TEST(Table, BreaksIntoBlocksThatBeginWithTheFirstColumn) {
  Table table({{"name", false}, {"one"}, {"two"}, {"three"}});
  table.add({"a", "1", "2", "3"});
  EXPECT_EQ(table.width(), 21u);
  EXPECT_EQ(table.text(21), table.text());
  EXPECT_EQ(table.text(14),
            "name  one  two\n"
            "----  ---  ---\n"
            "a       1    2\n"
            "\n"
            "name  three\n"
            "----  -----\n"
            "a         3\n");
  EXPECT_EQ(table.text(1).find("name  one\n"), 0u) << "a column at least";
}

TEST(Table, WrapsALastColumnOfText) {
  Table table({{"name", false}, {"n"}, {"meaning", false}});
  table.add({"a", "1", "one two three four five six seven"});
  table.add({"b", "2", "short"});
  EXPECT_EQ(table.text(34),
            "name  n  meaning\n"
            "----  -  -------------------------\n"
            "a     1  one two three four five\n"
            "         six seven\n"
            "b     2  short\n");
}

TEST(Fitted, BreaksWideLinesAtBlanksAndKeepsTheirIndent) {
  EXPECT_EQ(fitted("  aa bb cc dd\nshort\n", 9), "  aa bb\n    cc dd\nshort\n");
  EXPECT_EQ(fitted("aaaaaaaaaaaa\n", 5), "aaaaaaaaaaaa\n");
  EXPECT_EQ(fitted("a  b\n\n", 80), "a  b\n\n");
}

TEST(Entry, HasTheMeaningBesideOrBelowTheName) {
  EXPECT_EQ(entry("a", "b", 2, 6), "  a   b\n");
  EXPECT_EQ(entry("longer", "b", 2, 6), "  longer\n      b\n");
  EXPECT_EQ(entry("a", "", 2, 6), "  a\n");
}

TEST(Table, WithoutRowsIsItsHead) {
  EXPECT_EQ(Table({{"a"}, {"bc", false}}).text(), "a  bc\n-  --\n");
}

TEST(SignificantDigits, AreRounded) {
  EXPECT_EQ(significant(1.0 / 3.0, 3), "0.333");
  EXPECT_EQ(significant(433731.6, 6), "433732");
  EXPECT_EQ(significant(1.6e6, 6), "1.6e+06");
  EXPECT_EQ(significant(0.0, 4), "0");
}

TEST(SignificantDigits, OfWhatHasNoValueAreADash) {
  EXPECT_EQ(significant(std::numeric_limits<double>::quiet_NaN(), 3), "-");
  EXPECT_EQ(significant(std::numeric_limits<double>::infinity(), 3), "-");
}

}  // namespace
}  // namespace hapbench::table_test
