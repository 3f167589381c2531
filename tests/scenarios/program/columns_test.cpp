#include "scenarios/program/columns.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

/// Tests the printed values of varied fields.
namespace hapbench::columns_test {
namespace {

using Texts = std::vector<std::string>;

/// Returns the printed column of a varied field with these values.
Texts texts_of(const Texts& values) {
  std::vector<Cell> cells;
  for (const std::string& value : values) cells.push_back(axis_cell(value));
  return printed(cells, varied(under("field")), std::vector<std::optional<double>>(cells.size()));
}

TEST(VariedField, HasAtLeastFourDigitsAndNoExponentThatIsLonger) {
  EXPECT_EQ(texts_of({"1000", "2340.347319320716", "5477.225575051662", "12818.610191887026", "30000"}),
            (Texts{"1000", "2340", "5477", "12820", "30000"}));
  EXPECT_EQ(texts_of({"0.00048828125", "0.000244140625", "0.0001220703125", "6.103515625e-05"}),
            (Texts{"0.0004883", "0.0002441", "0.0001221", "6.104e-05"}));
  EXPECT_EQ(texts_of({"-12345678.9"}), Texts{"-12350000"});
  EXPECT_EQ(texts_of({"0.0004", "4e-05", "100000", "1e8"}), (Texts{"0.0004", "4e-05", "1e+05", "1e+08"}));
}

TEST(VariedField, HasAsManyDigitsAsDistinguishTheRows) {
  EXPECT_EQ(texts_of({"0.40001234", "0.40004321"}), (Texts{"0.40001", "0.40004"}));
  EXPECT_EQ(texts_of({"0.40001234", "0.40004321", "0.40001234"}), (Texts{"0.40001", "0.40004", "0.40001"}));
  EXPECT_EQ(texts_of({"0.400001234", "0.400004321"}), (Texts{"0.400001", "0.400004"}));
  EXPECT_EQ(texts_of({"0.4000001234", "0.4000004321"}), (Texts{"0.4", "0.4"})) << "at most six digits";
}

TEST(VariedField, IsExactIfItIsWholeOrHasAtMostSixDigits) {
  EXPECT_EQ(texts_of({"12345", "123.456", "0.1", "12345678", "9007199254740991"}),
            (Texts{"12345", "123.456", "0.1", "12345678", "9007199254740991"}));
}

TEST(VariedField, KeepsNamesAndJson) {
  EXPECT_EQ(texts_of({"mean", R"({"type":"ideal"})", "null", "0.123456789"}),
            (Texts{"mean", R"({"type":"ideal"})", "null", "0.1235"}));
}

}  // namespace
}  // namespace hapbench::columns_test
