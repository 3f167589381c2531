#include "scenarios/cases/league.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace hapbench::league_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Table A.3 of appendix D prints 0.004 ± 0.004 for a success rate and t = -21.5 against a rate of 1 for everybody.
TEST(PairedT, TellsThatAPrintedSuccessRateLacksADigit) {
  const std::vector<double> rates = {4.0 / 15.0, 0, 0, 0, 0, 0}, all(6, 1.0);
  EXPECT_NEAR(mean_of(rates), 0.0444, 5e-5);
  EXPECT_NEAR(standard_error(rates), 0.0444, 5e-5);
  EXPECT_NEAR(paired_t(rates, all), -21.50, 5e-3);
}

TEST(CriticalT, IsStudentsQuantile) {
  // scipy.stats.t.ppf(0.975, n); the table has three decimals.
  for (const auto& [degrees, t] : {std::pair{1u, 12.7062}, {5u, 2.5706}, {10u, 2.2281}})
    EXPECT_NEAR(critical_t(degrees), t, 5e-4) << degrees;
  EXPECT_EQ(critical_t(0), kInfinity);
  EXPECT_EQ(critical_t(11), critical_t(10));
}

// ---- The league

using Values = std::vector<std::optional<double>>;

/// One scene, metric and seed, or so many seeds; a value for each algorithm and seed. A negative one stands for a run
/// that diverged. Each number may be wrong by `error`.
League league_of(const Values& values, Better better = Better::less, std::size_t seeds = 1, double error = 0.0) {
  League league{{"scene"}, {}, {"force_max_N"}, {better}, seeds, {}};
  for (std::size_t a = 0; a < values.size() / seeds; ++a) league.algorithms.push_back("law_" + std::to_string(a));
  for (const auto& value : values) {
    const bool failed = value && *value < 0.0;
    league.runs.push_back({failed ? "diverges" : "completes", failed, league.runs.size(), {value}, {error}});
  }
  league.rank();
  return league;
}

std::vector<std::size_t> ranks(const League& league) {
  std::vector<std::size_t> ranks;
  for (const Standing& standing : league.standings) ranks.push_back(standing.rank.value_or(0));
  return ranks;
}

using Ranks = std::vector<std::size_t>;

TEST(League, RanksByMeansThenThoseWithoutOneThenByFailedSeeds) {
  constexpr std::nullopt_t kNone = std::nullopt;
  const auto of_one_seed = [](const Values& values, Better better = Better::less) {
    return ranks(league_of(values, better));
  };
  EXPECT_EQ(of_one_seed({6.0, 2.0, 3.0}), (Ranks{3, 1, 2}));
  EXPECT_EQ(of_one_seed({0.5, 1.0, 0.25}, Better::more), (Ranks{2, 1, 3}));
  EXPECT_EQ(of_one_seed({1.0, 2.0}, Better::none), (Ranks{0, 0}));
  EXPECT_EQ(of_one_seed({2.0, 1.0, 2.0, 5.0}), (Ranks{2, 1, 2, 4}));
  // 0.1 % of the larger of two is the limit: two are less than 1.0015 by more, the third is not.
  EXPECT_EQ(of_one_seed({1.0 + 1e-15, 1.0, 1.0009, 1.0015}), (Ranks{1, 1, 1, 3}));
  EXPECT_EQ(of_one_seed({0.0, 1e-300, 0.0}), (Ranks{1, 3, 1})) << "nothing is like zero";
  EXPECT_EQ(ranks(league_of({1.0, 1.3, 1.5}, Better::less, 1, 0.2)), (Ranks{1, 1, 2}))
      << "only the third is worse than the first by more than both errors";
  EXPECT_EQ(of_one_seed({kNone, 2.0, 1.0, kNone}), (Ranks{3, 2, 1, 3}));
  EXPECT_EQ(of_one_seed({-1.0, kNone, 2.0}), (Ranks{3, 2, 1}));
  EXPECT_EQ(of_one_seed({7.0, -1.0, 3.0, -9.0}), (Ranks{2, 3, 1, 3})) << "however small the numbers of failures";
  EXPECT_EQ(of_one_seed({-1.0, kNone}), (Ranks{0, 0})) << "nobody has a number that counts";
  // Failing with one seed of three beats two of three, whatever the rest is.
  const League league = league_of({9.0, 9.0, -1.0, 1.0, -1.0, -1.0, 50.0, 60.0, 70.0}, Better::less, 3);
  EXPECT_EQ(ranks(league), (Ranks{2, 3, 1}));
  EXPECT_EQ(league.at(0, 0, 0).mean, 9.0) << "of those that did not fail";
  EXPECT_EQ(league.at(0, 1, 0).outcome, "completes 1; diverges 2");
  // No seed is common to both: the law that never failed is judged by all.
  const League apart = league_of({-1.0, 2.0, 3.0, -1.0, 4.0, 6.0}, Better::less, 2);
  EXPECT_EQ(apart.at(0, 2, 0).common_seeds, 2u);
  EXPECT_EQ(apart.at(0, 2, 0).mean, 5.0);
}

}  // namespace
}  // namespace hapbench::league_test
