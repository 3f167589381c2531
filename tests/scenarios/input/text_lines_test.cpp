#include "scenarios/input/text_lines.hpp"

#include <gtest/gtest.h>

namespace hapbench::text_lines_test {
namespace {

TEST(WordsOf, AreSeparatedByAnyWhiteSpace) {
  EXPECT_EQ(words_of(""), Words{});
  EXPECT_EQ(words_of(" \t\r"), Words{});
  EXPECT_EQ(words_of("v 1\t 2\v3\f4 \r"), (Words{"v", "1", "2", "3", "4"}));
  const std::string zero("a\0b c", 5);
  EXPECT_EQ(words_of(zero), (Words{std::string_view(zero).substr(0, 3), "c"})) << "a zero byte ends nothing";
}

TEST(Numbers, AreTheWholeWordOrNone) {
  EXPECT_EQ(finite_number("-1.5e-3"), -0.0015);
  EXPECT_EQ(finite_number("0"), 0.0);
  for (const char* word : {"", "+1", "1.0x", "x", "nan", "inf", "-inf", "1e999", "0x10", " 1", "1,5"})
    EXPECT_EQ(finite_number(word), std::nullopt) << word;
  EXPECT_EQ(whole_number("18446744073709551615"), 18446744073709551615u);
  for (const char* word : {"", "-1", "+1", "1.0", "18446744073709551616", "x"})
    EXPECT_EQ(whole_number(word), std::nullopt) << word;
}

TEST(LineReader, GivesLinesWithTheirNumbersAndLeavesTheRest) {
  LineReader lines("a\n\nb\nrest");
  EXPECT_EQ(lines.line(), 0u);
  EXPECT_EQ(lines.next(), "a");
  EXPECT_EQ(lines.next(), "");
  EXPECT_EQ(lines.next(), "b");
  EXPECT_EQ(lines.line(), 3u);
  EXPECT_EQ(lines.rest(), "rest");
  EXPECT_EQ(lines.next(), "rest");
  EXPECT_EQ(lines.next(), std::nullopt);
  EXPECT_EQ(lines.line(), 4u);
  EXPECT_EQ(LineReader("").next(), std::nullopt);
}

}  // namespace
}  // namespace hapbench::text_lines_test
