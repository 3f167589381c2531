#include "scenarios/batch/ranking.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace hapbench::ranking_test {
namespace {

using Values = std::vector<std::optional<double>>;

/// Ranks one scene and one metric, with a value for each algorithm and seed. A negative value stands for a run that
/// diverged. The error of each number is `error`, unless `estimated` returns an error for the number.
Ranking rank_comparison(const Values& values, Better better = Better::less, std::size_t seeds = 1, double error = 0.0,
                        const EstimatedError& estimated = {}) {
  Ranking ranking{{"scene"}, {}, {"force_max_N"}, {better}, seeds, {}, {}};
  for (std::size_t a = 0; a < values.size() / seeds; ++a) ranking.algorithms.push_back("law_" + std::to_string(a));
  std::vector<Result> runs;
  for (const auto& value : values) {
    ranking.failed.push_back(value && *value < 0.0);
    Result& run = runs.emplace_back();
    run.end.outcome = ranking.failed.back() ? Outcome::diverges : Outcome::completes;
    run.state_hash = runs.size();
    Section(run.metrics, "").metric("force_max_N", "N", "", value, better).within(0.0, error);
  }
  ranking.runs = runs;
  ranking.estimated_error = estimated;
  ranking.rank();
  ranking.runs = {};
  return ranking;
}

/// Checks that the proxy's fidelity has no rank and does not change the ranks of other laws. The proxy renders by the
/// constraints of rigid contact, which also define the reference.
TEST(Ranking, DoesNotRankTheFidelityOfTheReferencesOwnConstraints) {
  for (const bool is_rigid : {true, false}) {
    Ranking ranking{{"scene"},
                    {"proxy", "mean", "summation"},
                    {"fidelity.force_error_rms_N", "force_max_N"},
                    {Better::less, Better::less},
                    1,
                    {},
                    {false, false, false},
                    {is_rigid}};
    std::vector<Result> runs(3);
    for (std::size_t a = 0; a < 3; ++a)
      for (const std::string& name : ranking.metrics)
        Section(runs[a].metrics, "").metric(name, "N", "", static_cast<double>(a + 1), Better::less).within(0.0, 0.0);
    ranking.runs = runs;
    ranking.rank();
    const auto rank = [&](std::size_t a, std::size_t m) { return ranking.at(0, a, m).rank.value_or(0); };
    EXPECT_EQ(rank(0, 0), is_rigid ? 0u : 1u);
    EXPECT_EQ(rank(1, 0), is_rigid ? 1u : 2u);
    EXPECT_EQ(rank(0, 1), 1u) << "other metrics are ranked";
    EXPECT_EQ(rank(2, 1), 3u);
  }
}

std::vector<std::size_t> ranks(const Ranking& ranking) {
  std::vector<std::size_t> ranks;
  for (const RankingEntry& entry : ranking.entries) ranks.push_back(entry.rank.value_or(0));
  return ranks;
}

using Ranks = std::vector<std::size_t>;

/// Checks that the ranks of `compare --errors` agree with the significant order that it prints.
TEST(Ranking, RespectsEstimatedErrors) {
  const auto ranks_with = [](std::vector<std::optional<double>> errors) {
    return ranks(rank_comparison({1.0, 1.3, 1.5}, Better::less, 1, 0.0,
                                 [errors](std::size_t run, const std::string&) { return errors[run]; }));
  };
  EXPECT_EQ(ranks_with({0.0, 0.0, 0.0}), (Ranks{1, 2, 3}));
  EXPECT_EQ(ranks_with({0.2, 0.2, 0.2}), (Ranks{1, 1, 2}));
  EXPECT_EQ(ranks_with({0.3, 0.3, 0.3}), (Ranks{0, 0, 0}));
  EXPECT_EQ(ranks_with({0.0, 0.0, std::nullopt}), (Ranks{1, 2, 0})) << "an unknown error";
  EXPECT_EQ(ranks_with({0.0, 2.0, 0.0}), (Ranks{1, 0, 2})) << "only a bound of the second is known";
}

TEST(Ranking, RanksByMeansThenThoseWithoutOneThenByFailedSeeds) {
  constexpr std::nullopt_t kNone = std::nullopt;
  const auto of_one_seed = [](const Values& values, Better better = Better::less) {
    return ranks(rank_comparison(values, better));
  };
  EXPECT_EQ(of_one_seed({6.0, 2.0, 3.0}), (Ranks{3, 1, 2}));
  EXPECT_EQ(of_one_seed({0.5, 1.0, 0.25}, Better::more), (Ranks{2, 1, 3}));
  EXPECT_EQ(of_one_seed({1.0, 2.0}, Better::none), (Ranks{0, 0}));
  EXPECT_EQ(of_one_seed({2.0, 1.0, 2.0, 5.0}), (Ranks{2, 1, 2, 4}));
  // Two numbers count as equal if they differ by at most 0.1 % of the larger number. So 1.0015 counts as larger than
  // the first two numbers, but as equal to the third number.
  EXPECT_EQ(of_one_seed({1.0 + 1e-15, 1.0, 1.0009, 1.0015}), (Ranks{1, 1, 1, 3}));
  EXPECT_EQ(of_one_seed({0.0, 1e-300, 0.0}), (Ranks{1, 3, 1})) << "nothing is like zero";
  EXPECT_EQ(ranks(rank_comparison({1.0, 1.3, 1.5}, Better::less, 1, 0.2)), (Ranks{1, 1, 2}))
      << "only the third is worse than the first by more than both errors";
  EXPECT_EQ(of_one_seed({kNone, 2.0, 1.0, kNone}), (Ranks{3, 2, 1, 3}));
  EXPECT_EQ(of_one_seed({-1.0, kNone, 2.0}), (Ranks{3, 2, 1}));
  EXPECT_EQ(of_one_seed({7.0, -1.0, 3.0, -9.0}), (Ranks{2, 3, 1, 3})) << "however small the numbers of failures";
  EXPECT_EQ(of_one_seed({-1.0, kNone}), (Ranks{0, 0})) << "nobody has a number that counts";
  // An algorithm that fails for one of three seeds ranks before an algorithm that fails for two seeds, whatever the
  // values for the other seeds are.
  const Ranking ranking = rank_comparison({9.0, 9.0, -1.0, 1.0, -1.0, -1.0, 50.0, 60.0, 70.0}, Better::less, 3);
  EXPECT_EQ(ranks(ranking), (Ranks{2, 3, 1}));
  EXPECT_EQ(ranking.at(0, 0, 0).mean, 9.0) << "of those that did not fail";
  EXPECT_EQ(ranking.at(0, 1, 0).outcome, "completes 1; diverges 2");
  // No seed is common to both laws: the law that never failed is ranked by all seeds.
  const Ranking without_common = rank_comparison({-1.0, 2.0, 3.0, -1.0, 4.0, 6.0}, Better::less, 2);
  EXPECT_EQ(without_common.at(0, 2, 0).common_seeds, 2u);
  EXPECT_EQ(without_common.at(0, 2, 0).mean, 5.0);
  EXPECT_EQ(without_common.at(0, 1, 0).common_seeds, 1u);
  EXPECT_TRUE(without_common.lacks_common_seeds(0));
  EXPECT_FALSE(ranking.lacks_common_seeds(0));
}

/// Checks ranks of laws whose values cannot be told apart, because the errors are too large.
/// tests/scripts/ranking_test.py tests the same rule for the HTML page.
TEST(Ranking, LeavesOutWhatTheErrorsDoNotAllow) {
  const auto with_error = [](const Values& values, double error) {
    return ranks(rank_comparison(values, Better::less, 1, error));
  };
  EXPECT_EQ(with_error({1.0, 1.1, 1.2}, 0.2), (Ranks{0, 0, 0})) << "no two can be told apart";
  EXPECT_EQ(with_error({1.0, 1.1, -1.0}, 0.2), (Ranks{1, 1, 3})) << "a failure can";
  EXPECT_EQ(with_error({0.1, 3.0, 9.0}, 0.4), (Ranks{0, 2, 3})) << "only a bound of the first is known";
  EXPECT_EQ(with_error({0.0, 3.0, 9.0}, 0.4), (Ranks{0, 2, 3}));
  EXPECT_EQ(with_error({0.0, 3.0, 9.0}, 0.0), (Ranks{1, 2, 3})) << "an exact zero";
  EXPECT_EQ(with_error({0.1, 3.0}, 0.4), (Ranks{0, 0})) << "a single rank says nothing";
  EXPECT_EQ(with_error({2.0}, 0.0), (Ranks{0}));
}

}  // namespace
}  // namespace hapbench::ranking_test
