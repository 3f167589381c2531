#include "scenarios/thesis_claims/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hapbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PairedT, IsTheMeanDifferenceOverItsStandardError) {
  // Differences 1, 2, 3: mean 2, standard deviation 1.
  EXPECT_NEAR(paired_t({2, 4, 6}, {1, 2, 3}), 2.0 * std::sqrt(3.0), 1e-14);
  EXPECT_EQ(paired_t({0, 0, 0}, {1, 1, 1}), -kInfinity) << "all pairs differ alike";
  EXPECT_EQ(paired_t({1, 2}, {1, 2}), 0.0);
  EXPECT_EQ(paired_t({1}, {2}), 0.0) << "one pair says nothing";
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
}  // namespace hapbench
