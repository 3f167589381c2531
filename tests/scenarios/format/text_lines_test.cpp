#include "scenarios/format/text_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

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

// ---- Comma-separated values

const std::filesystem::path kFile = "t.csv";

TEST(CsvReader, GivesRowsAsCells) {
  CsvReader csv{LineReader("a,b\r\n 1 ,\t2\r\n,\n\n3,4"), kFile};
  EXPECT_EQ(csv.header(), "a,b");
  EXPECT_EQ(csv.columns(), (Words{"a", "b"}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"1", "2"}));
  EXPECT_EQ(csv.line(), 2u);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"", ""}));
  ASSERT_TRUE(csv.next_not_blank());
  EXPECT_EQ(csv.cells(), (Words{"3", "4"}));
  EXPECT_EQ(csv.line(), 5u);
  EXPECT_FALSE(csv.next());
  EXPECT_FALSE(csv.next_not_blank());
}

// ---- Tables of numbers

class NumberTableFile : public testing::Test {
 protected:
  NumberTable read(const std::string& text, std::size_t most_rows = 100) const {
    test::write_plainly(file_, text);
    return number_table_in(read_named_file(file_), file_, "a,b", most_rows);
  }
  /// The refusal without the file in front.
  std::string refusal_of(const std::string& text, std::size_t most_rows = 100) const {
    SCOPED_TRACE(text);
    const auto error = test::input_error_of([&] { read(text, most_rows); });
    if (!error) return "";
    EXPECT_EQ(error->kind(), InputError::Kind::relation);
    const std::string message = error->what();
    EXPECT_EQ(message.find(file_.string()), 0u);
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message.substr(file_.string().size());
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "table.csv";
};

TEST_F(NumberTableFile, MayHaveBlanksBlankLinesCarriageReturnsAndNoLastLineEnd) {
  const NumberTable table = read("a,b\r\n\r\n 1 ,\t2\r\n  \n3,4");
  EXPECT_EQ(table.values, (std::vector<double>{1, 2, 3, 4}));
}

TEST_F(NumberTableFile, MayHaveAsManyRowsAsAllowed) {
  EXPECT_EQ(read("a,b\n1,2\n3,4\n", 2).rows(), 2u);
  EXPECT_EQ(refusal_of("a,b\n1,2\n3,4\n5,6\n", 2), ", line 4: more than 2 rows");
}

}  // namespace
}  // namespace hapbench::text_lines_test
