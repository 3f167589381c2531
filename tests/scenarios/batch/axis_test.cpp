#include "scenarios/batch/axis.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/batch/sweep_points.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::axis_test {
namespace {

using Values = std::vector<std::string>;

Values values_of(const std::string& text) {
  const Axis axis = parse_axis(text);
  Values values;
  for (std::size_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
  return values;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& value : values_of(text)) numbers.push_back(test::number_in(value));
  return numbers;
}

TEST(Axis, OfALinearRangeHasBothEndsAndDecimalsAsOneWritesThem) {
  EXPECT_EQ(parse_axis("a.b=0:1:11").path, "a.b");
  EXPECT_EQ(values_of("a=0:1:11"), (Values{"0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"}));
  EXPECT_EQ(values_of("a=10:-10:3"), (Values{"10", "0", "-10"}));
  EXPECT_EQ(values_of("a=100:1000:4"), (Values{"100", "400", "700", "1000"}));
}

TEST(Axis, OfALogarithmicRangeHasBothEndsAndDecades) {
  EXPECT_EQ(values_of("a=0.001:1000:7:log"), (Values{"0.001", "0.01", "0.1", "1", "10", "100", "1000"}));
  EXPECT_EQ(values_of("a=1000:10:3:log"), (Values{"1000", "100", "10"}));
}

TEST(Axis, EndPointsAreExactAndValuesBetweenThemInOrder) {
  for (const char* range :
       {"0.1:0.7:97", "0.1:0.7:97:log", "1e-300:1e300:97:log", "-1e300:1e300:97", "3:3.0000001:97"}) {
    const std::vector<double> values = numbers(std::string("a=") + range);
    const std::vector<std::string> parts = {std::string(range).substr(0, std::string(range).find(':'))};
    ASSERT_EQ(values.size(), 97u);
    EXPECT_EQ(values.front(), test::number_in(parts[0])) << range;
    for (std::size_t i = 1; i < values.size(); ++i) EXPECT_LT(values[i - 1], values[i]) << range << " " << i;
  }
  EXPECT_EQ(numbers("a=0.1:0.7:97").back(), 0.7);
  EXPECT_EQ(numbers("a=0.1:0.7:97:log").back(), 0.7);
  // The same value throughout stays the same: no rounding leaves the range.
  for (const double value : numbers("a=0.1:0.1:1000")) ASSERT_EQ(value, 0.1);
}

TEST(Axis, StepsAreEqualOrHaveEqualRatiosToRounding) {
  const std::vector<double> linear = numbers("a=0.3:7.1:60"), logarithmic = numbers("a=0.3:7.1:60:log");
  for (std::size_t i = 0; i < 60; ++i) {
    const double part = static_cast<double>(i) / 59.0;
    // Four roundings of at most half a unit of the largest value.
    EXPECT_NEAR(linear[i], 0.3 + (7.1 - 0.3) * part, 4 * 1.2e-16 * 7.1);
    // An error of some units of |log10| <= 1 is multiplied by ln 10 in the exponential function.
    EXPECT_NEAR(logarithmic[i] / (0.3 * std::pow(7.1 / 0.3, part)), 1.0, 16 * 2.3e-16);
  }
}

TEST(Axis, OfARangeKeepsNoneOfItsValues) {
  const Axis axis = parse_axis("a=0:999999:1000000");
  EXPECT_EQ(axis.size(), 1'000'000u);
  EXPECT_TRUE(axis.values.empty());
  EXPECT_EQ(axis.value(0), "0");
  EXPECT_EQ(axis.value(123'456), "123456");
  EXPECT_EQ(axis.value(999'999), "999999");
}

TEST(Axis, OfAListHasItsValuesInOrderAndNumbersInOneSpelling) {
  EXPECT_EQ(values_of("rendering.algorithm=mean,summation"), (Values{"mean", "summation"}));
  EXPECT_EQ(values_of("a=4e4,1.50,-0,true,null,7"), (Values{"40000", "1.5", "-0", "true", "null", "7"}));
  EXPECT_EQ(values_of("a=5"), Values{"5"});
}

TEST(Axis, RefusesWhatItCannotRead) {
  for (const char* text : {"",
                           "=",
                           "a",
                           "a=",
                           "=1,2",
                           "a b=1,2",
                           "a,b=1,2",
                           "a=1,,2",
                           "a=,",
                           "a=1:2",
                           "a=1:2:3:4:5",
                           "a=1:2:1",
                           "a=1:2:0",
                           "a=1:2:-3",
                           "a=1:2:2.5",
                           "a=1:2:1000001",
                           "a=1:2:99999999999999999999",
                           "a=x:2:3",
                           "a=1::3",
                           "a=nan:1:3",
                           "a=1:inf:3",
                           "a=1e301:2:3",
                           "a=0:1:5:log",
                           "a=-1:1:5:log",
                           "a=1:2:5:lin",
                           "a=1:2:5:",
                           "a=\"x\",y",
                           "a=x\ny,z",
                           "a=x\r,z",
                           "a=\x7f"}) {
    const auto error = test::input_error_of([&] { parse_axis(text); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find("--vary \""), std::string::npos) << error->what();
    EXPECT_NE(std::string(error->what()).find("allowed: "), std::string::npos) << error->what();
  }
}

TEST(Axis, RefusesTooManyValuesInAFewWords) {
  std::string list = "a=0";
  for (std::size_t i = 0; i < kMostRuns; ++i) list += ",0";
  const auto error = test::input_error_of([&] { parse_axis(list); });
  ASSERT_TRUE(error);
  EXPECT_LT(std::string(error->what()).size(), 500u);
}

}  // namespace
}  // namespace hapbench::axis_test
