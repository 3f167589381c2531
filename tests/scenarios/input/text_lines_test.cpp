#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"

namespace hapbench::text_lines_test {
namespace {

TEST(Numbers, AreTheWholeWordOrNone) {
  EXPECT_EQ(finite_number("-1.5e-3"), -0.0015);
  EXPECT_EQ(finite_number("0"), 0.0);
  for (const char* word : {"", "+1", "1.0x", "x", "nan", "inf", "-inf", "1e999", "0x10", " 1", "1,5"})
    EXPECT_EQ(finite_number(word), std::nullopt) << word;
  EXPECT_EQ(whole_number("18446744073709551615"), 18446744073709551615u);
  for (const char* word : {"", "-1", "+1", "1.0", "18446744073709551616", "x"})
    EXPECT_EQ(whole_number(word), std::nullopt) << word;
}

TEST(LineReader, SkipsAByteOrderMarkAndAcceptsAllLineEnds) {
  const auto lines_of = [](std::string_view text) {
    std::vector<std::string> lines;
    LineReader reader(text);
    while (const auto line = reader.next()) lines.emplace_back(*line);
    EXPECT_EQ(reader.line(), lines.size());
    return lines;
  };
  const std::vector<std::string> expected = {"a b", "", "c"};
  for (const std::string_view text : {"a b\n\nc", "a b\r\n\r\nc\r\n", "a b\r\rc\r",
                                      "\xEF\xBB\xBF"
                                      "a b\n\r\nc\n"})
    EXPECT_EQ(lines_of(text), expected) << text;
  EXPECT_EQ(lines_of("a\nb\rc\r\nd"), (std::vector<std::string>{"a", "b", "c", "d"}));
  EXPECT_TRUE(lines_of("").empty());
  EXPECT_TRUE(lines_of("\xEF\xBB\xBF").empty());
  // Binary data after a header with CR line ends may begin with LF.
  LineReader header("ply\rend_header\r\nx");
  header.next();
  header.next();
  EXPECT_EQ(header.rest(), "\nx");
  LineReader cut("a\nb");
  cut.next();
  EXPECT_TRUE(cut.has_line_end());
  cut.next();
  EXPECT_FALSE(cut.has_line_end());
}

}  // namespace
}  // namespace hapbench::text_lines_test
