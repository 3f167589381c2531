#include "scenarios/batch/league.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "scenarios/batch/statistics.hpp"
#include "tests/results/files.hpp"

namespace hapbench::league_test {
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

TEST(Statistics, QuantilesInterpolateBetweenRanks) {
  EXPECT_EQ(quantile_of({7.0}, 0.95), 7.0);
  EXPECT_EQ(quantile_of({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_EQ(quantile_of({4.0, 1.0, 3.0, 2.0}, 0.25), 1.75);  // numpy.quantile
  EXPECT_EQ(quantile_of({4.0, 1.0, 3.0, 2.0}, 1.0), 4.0);
}

TEST(CriticalT, IsStudentsQuantileForAnyDegreesOfFreedom) {
  EXPECT_EQ(critical_t(0), kInfinity);
  for (std::size_t degrees = 1; degrees < 50; ++degrees) EXPECT_GT(critical_t(degrees), critical_t(degrees + 1));
  // scipy.stats.t.ppf(0.975, n); the table has three decimals.
  for (const auto& [degrees, t] :
       {std::pair{1u, 12.7062}, {10u, 2.2281}, {11u, 2.2010}, {15u, 2.1314}, {29u, 2.0452}, {99u, 1.9842}})
    EXPECT_NEAR(critical_t(degrees), t, 5e-4) << degrees;
}

TEST(MeanOf, IsNoNumberWithoutValues) {
  EXPECT_EQ(mean_of({1.0, 2.0, 6.0}), 3.0);
  EXPECT_TRUE(std::isnan(mean_of({})));
}

// ---- The league

using Values = std::vector<std::optional<double>>;

/// One metric; `values` by scenario, algorithm and seed. A negative value stands for a run that diverged.
League league_of(std::size_t scenarios, std::size_t algorithms, std::size_t seeds, const Values& values,
                 Better better = Better::less) {
  LeagueRuns runs;
  for (std::size_t s = 0; s < scenarios; ++s) runs.scenarios.push_back("scene_" + std::to_string(s));
  for (std::size_t a = 0; a < algorithms; ++a) runs.algorithms.push_back("law_" + std::to_string(a));
  runs.metrics = {"force_max_N"};
  runs.better = {better};
  runs.seeds = seeds;
  for (const auto& value : values) {
    const bool failed = value && *value < 0.0;
    // Every run is another one, unless a test says otherwise.
    runs.runs.push_back({failed ? "diverges" : "completes", failed, runs.runs.size(), {value}});
  }
  EXPECT_EQ(runs.runs.size(), scenarios * algorithms * seeds);
  return make_league(std::move(runs));
}

std::vector<std::size_t> ranks(const League& league, std::size_t scenario) {
  std::vector<std::size_t> ranks;
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    ranks.push_back(league.at(scenario, a, 0).rank.value_or(0));
  }
  return ranks;
}

using Ranks = std::vector<std::size_t>;

TEST(League, RanksByMeansThenThoseWithoutOneThenByFailedSeeds) {
  constexpr std::nullopt_t kNone = std::nullopt;
  const auto of_one_seed = [](const Values& values, Better better = Better::less) {
    return ranks(league_of(1, values.size(), 1, values, better), 0);
  };
  EXPECT_EQ(of_one_seed({6.0, 2.0, 3.0}), (Ranks{3, 1, 2}));
  EXPECT_EQ(of_one_seed({0.5, 1.0, 0.25}, Better::more), (Ranks{2, 1, 3}));
  EXPECT_EQ(of_one_seed({1.0, 2.0}, Better::none), (Ranks{0, 0}));
  EXPECT_EQ(of_one_seed({2.0, 1.0, 2.0, 5.0}), (Ranks{2, 1, 2, 4}));
  // 0.1 % of the larger of two is the limit, taken from the first of a group: 1.0009 is of the first, 1.0015 is not,
  // though close to the one before.
  EXPECT_EQ(of_one_seed({1.0 + 1e-15, 1.0, 1.0009, 1.0015}), (Ranks{1, 1, 1, 4}));
  EXPECT_EQ(of_one_seed({0.0, 1e-300, 0.0}), (Ranks{1, 3, 1})) << "nothing is like zero";
  EXPECT_EQ(of_one_seed({kNone, 2.0, 1.0, kNone}), (Ranks{3, 2, 1, 3}));
  EXPECT_EQ(of_one_seed({-1.0, kNone, 2.0}), (Ranks{3, 2, 1}));
  EXPECT_EQ(of_one_seed({7.0, -1.0, 3.0, -9.0}), (Ranks{2, 3, 1, 3})) << "however small the numbers of failures";
  EXPECT_EQ(of_one_seed({-1.0, kNone}), (Ranks{0, 0})) << "nobody has a number that counts";
  // Failing with one seed of three beats two of three, whatever the rest is.
  const League league = league_of(1, 3, 3, {9.0, 9.0, -1.0, 1.0, -1.0, -1.0, 50.0, 60.0, 70.0});
  EXPECT_EQ(ranks(league, 0), (Ranks{2, 3, 1}));
  EXPECT_EQ(league.failures(0, 1), 2u);
  EXPECT_EQ(league.at(0, 0, 0).mean, 9.0) << "of those that did not fail";
}

TEST(League, TakesMeansOverTheSeedsInWhichNobodyFailed) {
  // Law 0 fails with seed 0, on which law 1 is bad; over its survivors alone law 1 would look worse than it is.
  const League league = league_of(1, 3, 3, {-1.0, 2.0, 3.0, 90.0, 1.0, 2.0, -1.0, -1.0, -1.0});
  EXPECT_EQ(league.common[0], (std::vector<std::size_t>{1, 2})) << "the law that always fails takes no seed away";
  EXPECT_EQ(league.at(0, 0, 0).mean, 2.5);
  EXPECT_EQ(league.at(0, 1, 0).mean, 1.5);
  EXPECT_FALSE(league.at(0, 2, 0).mean);
  EXPECT_EQ(ranks(league, 0), (Ranks{2, 1, 3}));
  // No seed is common to both: the law that never failed is judged by all.
  const League apart = league_of(1, 3, 2, {-1.0, 2.0, 3.0, -1.0, 4.0, 6.0});
  EXPECT_EQ(apart.common[0].size(), 2u);
  EXPECT_EQ(apart.at(0, 2, 0).mean, 5.0);
}

TEST(League, KnowsNoSpreadWhereSeedsChangeNothing) {
  League made = league_of(1, 2, 2, {1.0, 1.0, 2.0, 2.0});
  EXPECT_TRUE(made.seeds_matter[0]);
  LeagueRuns runs = made.runs;
  for (LeagueRun& run : runs.runs) run.state_hash = 7;
  const League league = make_league(std::move(runs));
  EXPECT_FALSE(league.seeds_matter[0]);
  EXPECT_FALSE(league.at(0, 1, 0).spread);
}

TEST(League, SumsUpEachAlgorithmOverTheScenarios) {
  // law_0: ranks 1, 3 (failed); law_1: ranks 2, 1; law_2: ranks 3, 2.
  const League league = league_of(2, 3, 1, {1.0, 4.0, 9.0, -1.0, 2.0, 8.0});
  ASSERT_EQ(league.laws.size(), 3u);
  EXPECT_EQ(league.laws[0].algorithm, 1u);
  EXPECT_EQ(league.laws[0].mean_rank, 1.5);
  EXPECT_EQ(league.laws[0].fails, Ranks{});
  EXPECT_EQ(league.laws[1].algorithm, 0u);
  EXPECT_EQ(league.laws[1].mean_rank, 2.0);
  EXPECT_EQ(league.laws[1].fails, Ranks{1});
  EXPECT_EQ(league.laws[2].algorithm, 2u);
  EXPECT_EQ(league.laws[2].mean_rank, 2.5);
}

TEST(LeagueFile, HasARowForEachScenarioAlgorithmAndMetric) {
  const test::TemporaryDirectory directory;
  const League league = league_of(1, 3, 3, {1.0, 3.0, 8.0, 4.0, 6.0, 8.0, 5.0, 6.0, -1.0});
  write_league(directory / "league.csv", league);
  const auto lines = test::lines_of(test::read_file(directory / "league.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0], "scenario,algorithm,metric,seeds,failed,outcome,mean,spread,rank,common_seeds,better");
  EXPECT_EQ(lines[1].find("scene_0,law_0,force_max_N,3,0,completes,2,1.414"), 0u) << lines[1];
  EXPECT_TRUE(lines[2].ends_with(",2,2,less")) << lines[2];
  EXPECT_EQ(lines[3].find("scene_0,law_2,force_max_N,3,1,completes 2; diverges 1,5.5,0.707"), 0u) << lines[3];
  EXPECT_TRUE(lines[3].ends_with(",3,2,less")) << lines[3];
  const Json json = league_json(league);
  EXPECT_EQ(json["standings"].size(), 3u);
  EXPECT_EQ(json["standings"][1]["rank"], 2);
  EXPECT_EQ(json["laws"][2]["fails"], Json({"scene_0"}));
}

}  // namespace
}  // namespace hapbench::league_test
