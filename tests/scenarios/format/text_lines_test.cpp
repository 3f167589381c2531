#include "scenarios/format/text_lines.hpp"

#include <gtest/gtest.h>

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

TEST(NumberTable, MayHaveBlanksBlankLinesCarriageReturnsAndAsManyRowsAsAllowed) {
  const std::string text = "a,b\r\n\r\n 1 ,\t2\r\n  \n3,4";
  EXPECT_EQ(number_table_in(text, kFile, {"a,b"}, 2).values, (std::vector<double>{1, 2, 3, 4}));
  const auto error = test::input_error_of([&] { number_table_in(text, kFile, {"a,b"}, 1); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "t.csv, line 5: more than 1 rows");
}

}  // namespace
}  // namespace hapbench::text_lines_test
