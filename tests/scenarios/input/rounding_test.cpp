#include <gtest/gtest.h>

#include <limits>

#include "scenarios/input/rounding.hpp"

namespace hapbench::rounding_test {
namespace {

TEST(RoundedToDigits, IsTheNumberThatIsWritten) {
  EXPECT_EQ(rounded_to_digits(0.12345, 2), 0.12);
  EXPECT_EQ(rounded_to_digits(-98765.0, 3), -98800.0);
  EXPECT_EQ(rounded_to_digits(1.0 / 3.0, 6), 0.333333);
  EXPECT_EQ(rounded_to_digits(0.0, 2), 0.0);
  EXPECT_EQ(rounded_to_digits(std::numeric_limits<double>::infinity(), 2), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace hapbench::rounding_test
