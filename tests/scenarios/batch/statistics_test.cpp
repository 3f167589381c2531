#include "scenarios/batch/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace hapbench::statistics_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PairedT, IsTheMeanDifferenceOverItsStandardError) {
  // Differences 1, 2, 3: mean 2, standard deviation 1.
  EXPECT_NEAR(paired_t({2, 4, 6}, {1, 2, 3}), 2.0 * std::sqrt(3.0), 1e-14);
  EXPECT_EQ(paired_t({0, 0, 0}, {1, 1, 1}), -kInfinity) << "all pairs differ alike";
  EXPECT_EQ(paired_t({1, 2}, {1, 2}), 0.0);
  EXPECT_EQ(paired_t({1}, {2}), 0.0) << "one pair says nothing";
}

/// Table A.3 of appendix D prints 0.004 ± 0.004 for a success rate and t = -21.5 against a rate of 1 for everybody.
TEST(PairedT, TellsThatAPrintedSuccessRateLacksADigit) {
  const std::vector<double> rates = {4.0 / 15.0, 0, 0, 0, 0, 0}, all(6, 1.0);
  EXPECT_NEAR(mean_of(rates), 0.0444, 5e-5);
  EXPECT_NEAR(standard_error(rates), 0.0444, 5e-5);
  EXPECT_NEAR(paired_t(rates, all), -21.50, 5e-3);
}

TEST(StandardDeviation, IsThatOfASample) {
  EXPECT_DOUBLE_EQ(standard_deviation({1.0, 2.0, 3.0}), 1.0);
  EXPECT_DOUBLE_EQ(standard_error({1.0, 2.0, 3.0}), 1.0 / std::sqrt(3.0));
  EXPECT_EQ(standard_deviation({5.0}), 0.0);
  EXPECT_EQ(standard_error({}), 0.0);
}

TEST(CriticalT, FallsWithTheDegreesOfFreedom) {
  EXPECT_EQ(critical_t(0), kInfinity);
  for (std::size_t degrees = 1; degrees < 10; ++degrees) EXPECT_GT(critical_t(degrees), critical_t(degrees + 1));
  EXPECT_EQ(critical_t(50), critical_t(10));
}

TEST(MeanOf, IsNoNumberWithoutValues) {
  EXPECT_EQ(mean_of({1.0, 2.0, 6.0}), 3.0);
  EXPECT_TRUE(std::isnan(mean_of({})));
}

}  // namespace
}  // namespace hapbench::statistics_test
