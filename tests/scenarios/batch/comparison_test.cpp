#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/scene/named_files.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::comparison_test {
namespace {

namespace fs = std::filesystem;

class ComparisonOf : public testing::Test {
 protected:
  fs::path write(const std::string& name, const Json& scenario) const {
    test::write_plainly(directory_ / name, scenario.dump());
    return directory_ / name;
  }
  /// Two scenes, the second with random springs.
  ComparisonQuestion two_scenes() const {
    Json springs = test::minimal_scenario("springs");
    springs["environment"] = {{"type", "springs"}, {"random", {{"count", 5}}}};
    springs["initial"] = {{"position_m", {0.001, 0.0, 0.0}}};
    springs["seed"] = 40;
    return {.scenarios = {write("plane.json", test::minimal_scenario("plane")), write("springs.json", springs)},
            .algorithms = {"mean", "summation"},
            .seeds = 3};
  }
  std::string refused(const ComparisonQuestion& question) const {
    const auto error = test::input_error_of([&] { planned(question); });
    return error ? error->what() : "";
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ComparisonOf, SeveralScenesNumbersRunsSceneByScene) {
  const Comparison comparison = planned(two_scenes());
  ASSERT_EQ(comparison.size(), 12u);
  EXPECT_EQ(comparison.folder(0), "plane/mean/seed_0");
  EXPECT_EQ(comparison.folder(5), "plane/summation/seed_2");
  EXPECT_EQ(comparison.folder(11), "springs/summation/seed_2");
  EXPECT_EQ(comparison.load(11).scenario.seed, 42);
  EXPECT_EQ(comparison.load(11).scenario.rendering.algorithm, "summation");
  ComparisonQuestion one = two_scenes();
  one.scenarios.pop_back();
  one.seeds = 1;
  EXPECT_EQ(planned(one).folder(1), "summation");
}

TEST_F(ComparisonOf, JitteredScenesStartFromOnePlaceForEachSeed) {
  ComparisonQuestion question = two_scenes();
  question.jitter = 1e-4;
  const Comparison comparison = planned(question);
  const auto start = [&](std::size_t run) { return comparison.load(run).scenario.initial.position; };
  for (std::size_t seed = 0; seed < 3; ++seed) {
    // Norms of sums of three rounded squares are exact to a few units in the last place.
    EXPECT_NEAR(start(seed).norm(), 1e-4, 1e-18);
    EXPECT_EQ(start(seed), start(3 + seed)) << "the other algorithm";
    EXPECT_NE(start(seed), start((seed + 1) % 3));
    // Springs in the plane stay there. Adding to 1e-3 rounds by up to 1e-19.
    EXPECT_EQ(start(6 + seed).z(), 0.0);
    EXPECT_NEAR((start(6 + seed) - Vec3(0.001, 0.0, 0.0)).norm(), 1e-4, 1e-18);
  }
}

TEST_F(ComparisonOf, WhatCannotBeComparedSaysWhichFile) {
  ComparisonQuestion question = two_scenes();
  Json script = test::minimal_scenario("plane");
  script["motion"] = {{"position", {{"type", "prescribed"}, {"x_m", 0.0}, {"y_m", 0.0}, {"z_m", 0.0}}}};
  question.scenarios.push_back(write("script.json", script));
  EXPECT_NO_THROW(planned(question));
  question.jitter = 1e-4;
  EXPECT_NE(refused(question).find("script.json: /motion/position: "), std::string::npos) << refused(question);
  question = two_scenes();
  fs::create_directory(directory_ / "copy");
  question.scenarios.push_back(write("copy/plane.json", test::minimal_scenario("plane")));
  EXPECT_NE(refused(question).find("a second scenario named \"plane\"; allowed: "), std::string::npos);
  question = two_scenes();
  question.overrides = {"seed=9007199254740991"};  // 2^53 - 1: two more is too many
  EXPECT_NE(refused(question).find("/seed: got 9007199254740991; allowed: at most "), std::string::npos);
  question.seeds = 1'000'000;
  EXPECT_NE(refused(question).find("= 4000000 runs; allowed: at most 1000000"), std::string::npos);
}

TEST_F(ComparisonOf, ScenesRemovesWhatAnEarlierOneLeftAndNothingElse) {
  const fs::path out = directory_ / "out";
  for (const char* name : {"league.csv", "plane/comparison.csv", "plane/mean/seed_1/summary.json",
                           "plane/proxy/summary.json", "plane/proxy/notes.txt", "plane/mine/summary.json"}) {
    fs::create_directories((out / name).parent_path());
    test::write_plainly(out / name, "x");
  }
  remove_earlier_comparison(out, planned(two_scenes()));
  EXPECT_EQ(test::names_below(out), (std::vector<std::string>{"plane/mine/summary.json", "plane/proxy/notes.txt"}));
  EXPECT_FALSE(fs::exists(out / "plane/mean"));
}

/// Two blocks of different grids, one of them twice with another start, however many runs each has and whoever comes
/// first.
TEST_F(ComparisonOf, AnyScenesBuildsEachDistinctShellOnce) {
  for (const unsigned jobs : {1u, 4u}) {
    Json scene = test::minimal_scenario("block_with_hole");
    ComparisonQuestion question{.scenarios = {}, .algorithms = {"mean", "summation", "proxy"}, .seeds = 4};
    for (const auto& [name, grid] : {std::pair{"a", 1e-4}, {"b", 2e-4}, {"c", 1e-4}}) {
      scene["environment"]["grid_m"] = grid + 1e-6 * jobs;  // shells that no earlier run has left
      scene["initial"]["position_m"] = {0.0, 0.0, name[0] == 'c' ? 1e-3 : 0.0};
      question.scenarios.push_back(write(std::string(name) + ".json", scene));
    }
    const Comparison comparison = planned(question);
    const std::size_t before = shared_cache().made();
    run_all(comparison.scenes, {.threads = jobs, .label = ""});
    EXPECT_EQ(shared_cache().made() - before, 2u) << jobs << " jobs";
  }
}

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
  League league{{"scene"}, {}, {"force_max_N"}, {better}, seeds, {}, {}};
  for (std::size_t a = 0; a < values.size() / seeds; ++a) league.algorithms.push_back("law_" + std::to_string(a));
  std::vector<Result> runs;
  for (const auto& value : values) {
    league.failed.push_back(value && *value < 0.0);
    Result& run = runs.emplace_back();
    run.end.outcome = league.failed.back() ? Outcome::diverges : Outcome::completes;
    run.state_hash = runs.size();
    Section(run.metrics, "").metric("force_max_N", "N", "", value, better).within(0.0, error);
  }
  league.runs = runs;
  league.rank();
  league.runs = {};
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
}  // namespace hapbench::comparison_test
