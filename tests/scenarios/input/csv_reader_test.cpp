#include "scenarios/input/csv_reader.hpp"

#include <gtest/gtest.h>

#include "tests/scenarios/support/errors.hpp"

namespace hapbench::csv_reader_test {
namespace {

const std::filesystem::path kFile = "t.csv";

TEST(CsvReader, GivesRowsAsCells) {
  CsvReader csv{LineReader("a,b\r\n 1 ,\t2\r\n,\n\n3,4"), kFile};
  EXPECT_EQ(csv.header(), "a,b");
  EXPECT_EQ(csv.columns(), (Words{"a", "b"}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"1", "2"}));
  EXPECT_EQ(csv.row(), " 1 ,\t2\r");
  EXPECT_EQ(csv.line(), 2u);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"", ""}));
  ASSERT_TRUE(csv.next_not_blank());
  EXPECT_EQ(csv.cells(), (Words{"3", "4"}));
  EXPECT_EQ(csv.line(), 5u);
  EXPECT_FALSE(csv.next());
  EXPECT_FALSE(csv.next_not_blank());
}

TEST(CsvReader, OfNothingHasNoHeader) {
  CsvReader csv{LineReader(""), kFile};
  EXPECT_EQ(csv.header(), "");
  EXPECT_FALSE(csv.next());
}

TEST(CsvReader, RefusesRowsOfAnotherLength) {
  for (const char* text : {"a,b\n1,2\n3\n", "a,b\n1,2\n3,4,5\n", "a,b\n1,2\n\n"}) {
    CsvReader csv{LineReader(text), kFile};
    ASSERT_TRUE(csv.next());
    const auto error = test::input_error_of([&] { csv.next(); });
    ASSERT_TRUE(error) << text;
    EXPECT_TRUE(std::string(error->what()).starts_with("t.csv, line 3: got ")) << error->what();
    EXPECT_TRUE(std::string(error->what()).ends_with(" cells; allowed: 2")) << error->what();
  }
}

}  // namespace
}  // namespace hapbench::csv_reader_test
