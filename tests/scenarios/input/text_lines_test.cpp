#include <gtest/gtest.h>

#include <optional>

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

}  // namespace
}  // namespace hapbench::text_lines_test
