#include "scenarios/batch/row_condition.hpp"

#include <gtest/gtest.h>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

const std::vector<std::string> kColumns = {"index", "a", "outcome"};
const std::vector<std::vector<std::string>> kRows = {
    {"0", "3", "completes"}, {"1", "3.0", "diverges"}, {"2", "4", "completes"}, {"3", "", "error"}, {"4", "nan", ""}};

/// Returns the first cells of the rows that meet the condition, joined without a separator.
std::string kept(const std::string& condition) {
  const RowCondition is_met = parse_row_condition(condition, kColumns);
  std::string all;
  for (const auto& row : kRows)
    if (is_met(row)) all += row[0];
  return all;
}

TEST(RowCondition, ComparesNumbersByValueAndKeepsNoRowWithoutANumber) {
  EXPECT_EQ(kept("a=3"), "01");
  EXPECT_EQ(kept("a=3e0"), "01");
  EXPECT_EQ(kept("a!=3"), "2");
  EXPECT_EQ(kept("a<=3"), "01");
  EXPECT_EQ(kept("a<3"), "");
  EXPECT_EQ(kept("a>3"), "2");
  EXPECT_EQ(kept("a>=3"), "012");
  EXPECT_EQ(kept("outcome>=0"), "");
}

TEST(RowCondition, ComparesTextsLetterByLetter) {
  EXPECT_EQ(kept("outcome=completes"), "02");
  EXPECT_EQ(kept("outcome!=completes"), "134");
  EXPECT_EQ(kept("a=nan"), "4");
}

TEST(RowCondition, IsOneOfSixComparisonsOfAColumnWithAValue) {
  for (const char* text : {"a==3", "a=<3", "a~3", "a<>3", "a", "a<", "a=", "", "outcome<completes", "a<nan"}) {
    try {
      parse_row_condition(text, kColumns);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("one of < <= > >= = !="), std::string::npos) << error.what();
    }
  }
  try {
    parse_row_condition("outcom=completes", kColumns);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nearest valid name: \"outcome\""), std::string::npos) << error.what();
  }
}

TEST(RowCondition, SeveralAreMetByARowThatMeetsAll) {
  const RowCondition both = parse_row_conditions({"a<=3", "outcome=completes"}, kColumns);
  EXPECT_TRUE(both(kRows[0]));
  EXPECT_FALSE(both(kRows[1]));
  EXPECT_FALSE(both(kRows[2]));
  EXPECT_TRUE(parse_row_conditions({}, kColumns)(kRows[3]));
}

}  // namespace
}  // namespace hapbench
