#include "scenarios/batch/statistics.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace hapbench::statistics_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Checks a number of the thesis: Table A.3 of appendix D prints 0.004 ± 0.004 for a success rate. It also prints t =
/// -21.5 for the comparison with a rate of 1 for all subjects, which shows that a digit of the rate is missing.
TEST(PairedT, ShowsThatAPrintedSuccessRateLacksADigit) {
  const std::vector<double> rates = {4.0 / 15.0, 0, 0, 0, 0, 0}, all(6, 1.0);
  EXPECT_NEAR(mean_of(rates), 0.0444, 5e-5);
  EXPECT_NEAR(standard_error(rates), 0.0444, 5e-5);
  EXPECT_NEAR(paired_t(rates, all), -21.50, 5e-3);
}

TEST(CriticalT, IsStudentsQuantile) {
  // Expected values of scipy.stats.t.ppf(0.975, n); the table of the program has three decimals.
  for (const auto& [degrees, t] : {std::pair{1u, 12.7062}, {5u, 2.5706}, {10u, 2.2281}})
    EXPECT_NEAR(critical_t(degrees), t, 5e-4) << degrees;
  EXPECT_EQ(critical_t(0), kInfinity);
  EXPECT_EQ(critical_t(11), critical_t(10));
}

}  // namespace
}  // namespace hapbench::statistics_test
