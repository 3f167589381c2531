#include "scenarios/thesis/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/core/random.hpp"

namespace hapbench::sensitivity_test {
namespace {

using Bins = std::vector<std::size_t>;
using Values = std::vector<double>;

Values uniform(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Values values(count);
  for (double& value : values) value = random.uniform();
  return values;
}

TEST(EqualCountBins, CutTheValuesInOrder) {
  EXPECT_EQ(equal_count_bins(Values{3, 1, 2, 4}, 2), (Bins{1, 0, 0, 1}));
  EXPECT_EQ(equal_count_bins(Values{5, 5, 5}, 3), (Bins{0, 1, 2}));
  EXPECT_TRUE(equal_count_bins(Values{}, 3).empty());
}

TEST(FirstOrderIndex, IsTheFormulasByHand) {
  // Means 0.25 and 1 about 0.625: SST = 1.875, SSB = 2 * 4 * 0.375^2 = 1.125, SSW = 0.75 with 8 - 2 degrees of freedom.
  const Bins bin = {0, 0, 0, 0, 1, 1, 1, 1};
  const Values y = {0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_NEAR(first_order_index(bin, y), (1.125 - 0.75 / 6.0) / 1.875, 1e-15);
  EXPECT_EQ(first_order_index(bin, Values{0, 0, 0, 0, 1, 1, 1, 1}), 1.0);
  EXPECT_TRUE(std::isnan(first_order_index(bin, Values(8, 1.0)))) << "nothing changes";
  EXPECT_TRUE(std::isnan(first_order_index(Bins{0, 1}, Values{0, 1}))) << "every bin has one point";
}

TEST(DecidingInput, IsTheOneThatDecidesOrNone) {
  constexpr std::size_t kPoints = 96;
  std::vector<Bins> bins;
  std::vector<Values> inputs;
  for (std::uint64_t i = 0; i < 10; ++i) {
    inputs.push_back(uniform(kPoints, 100 + i));
    bins.push_back(equal_count_bins(inputs.back(), 6));
  }
  Values y(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) y[i] = inputs[7][i] < 0.3 ? 1.0 : 0.0;
  const auto deciding = deciding_input(bins, y, 1);
  ASSERT_TRUE(deciding);
  EXPECT_EQ(deciding->input, 7u);
  EXPECT_GT(deciding->index, 0.8);
  EXPECT_FALSE(deciding_input(bins, Values(kPoints, 1.0), 1)) << "y never changes";
}

TEST(DecidingInput, RaisesFalseAlarmsAtItsLevelOnly) {
  constexpr std::size_t kPoints = 64, kTrials = 300;
  std::vector<Bins> bins;
  for (std::uint64_t i = 0; i < 10; ++i) bins.push_back(equal_count_bins(uniform(kPoints, 500 + i), 4));
  std::size_t alarms = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Values y = uniform(kPoints, 9000 + trial);
    for (double& value : y) value = value < 0.4 ? 1.0 : 0.0;
    if (deciding_input(bins, y, trial, 0.05, 99)) ++alarms;
  }
  // Binomial with p = 0.05: 15 of 300 on average, standard deviation 3.8.
  EXPECT_LE(alarms, 15u + 4 * 4);
  EXPECT_GE(alarms, 1u) << "the level is not that of something else";
}

}  // namespace
}  // namespace hapbench::sensitivity_test
