#include <gtest/gtest.h>

#include <filesystem>
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
  EXPECT_EQ(csv.header(), "a,b");
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

TEST(NumberTable, MayHaveBlanksBlankLinesCarriageReturnsAndAsManyRowsAsAllowed) {
  const std::string text = "a,b\r\n\r\n 1 ,\t2\r\n  \n3,4";
  EXPECT_EQ(parse_number_table(text, kFile, {"a,b"}, 2).values, (std::vector<double>{1, 2, 3, 4}));
  const auto error = test::input_error_of([&] { parse_number_table(text, kFile, {"a,b"}, 1); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "t.csv, line 5: more than 1 rows");
}

}  // namespace
}  // namespace hapbench::number_table_test
