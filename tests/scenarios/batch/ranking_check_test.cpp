#include "scenarios/batch/ranking_check.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Whether a ranking holds when scenes are sampled more finely.
namespace hapbench::ranking_check_test {
namespace {

using Numbers = std::vector<double>;
constexpr double kNone = std::numeric_limits<double>::infinity();

Holding judged(const Numbers& before, const Numbers& after, bool ranked = true) {
  return judged_column({before}, {after}, ranked).holding;
}

TEST(JudgedColumn, FlipsWhenTwoThatAreApartBothTimesChangeTheirOrder) {
  EXPECT_EQ(judged({1.0, 2.0, 3.0}, {2.0, 1.0, 3.0}), Holding::flips);
  EXPECT_EQ(judged({1.0, 2.0}, {2.0, 1.0}, false), Holding::drifts) << "nothing is better or worse";
  // 10 % of the larger is the limit, before and after.
  EXPECT_EQ(judged({1.0, 1.12}, {1.12, 1.0}), Holding::flips);
  EXPECT_EQ(judged({1.0, 1.1}, {1.1, 1.0}), Holding::holds);
  EXPECT_EQ(judged({1.0, 1.2}, {1.2, 1.1}), Holding::drifts);
  EXPECT_EQ(judged({1.0, 1.0}, {1.0, 2.0}), Holding::drifts) << "were alike";
}

TEST(JudgedColumn, TakesFailuresForTheWorst) {
  EXPECT_EQ(judged({1.0, 2.0}, {kNone, 2.0}), Holding::flips);
  EXPECT_EQ(judged({kNone, 2.0}, {1.0, 2.0}), Holding::flips);
  EXPECT_EQ(judged({1.0, 2.0}, {1.0, kNone}), Holding::drifts);
  EXPECT_EQ(judged({1.0, kNone}, {1.0, kNone}), Holding::holds);
}

TEST(JudgedColumn, OverlooksWhatIsSmallBesideTheLargest) {
  EXPECT_EQ(judged({1e-5, 2e-5, 1.0}, {2e-5, 1e-5, 1.0}), Holding::holds);
  EXPECT_EQ(judged({1e-5, 2e-5}, {2e-5, 1e-5}), Holding::flips);
  EXPECT_EQ(judged({0.0, 0.0}, {0.0, 0.0}), Holding::holds);
  EXPECT_EQ(judged({0.0, 1.0}, {1e-12, 1.0}), Holding::holds);
}

TEST(JudgedColumn, OverlooksWhatTheNumbersMayBeWrongBy) {
  const Numbers before{1.0, 1.5, 9.0}, after{1.5, 1.0, 9.0};
  const auto with = [&](const Numbers& tolerances) {
    return judged_column({before, tolerances}, {after, tolerances}, true).holding;
  };
  EXPECT_EQ(with({0.2, 0.2, 100.0}), Holding::flips) << "whatever the third may be wrong by";
  EXPECT_EQ(with({0.2, 0.3, 0.0}), Holding::drifts) << "as the first number does";
  EXPECT_EQ(with({0.25, 0.3, 0.0}), Holding::holds);
}

TEST(JudgedColumn, NamesTheLawsThatShowIt) {
  const ColumnVerdict flips = judged_column({Numbers{1.0, 1.5, 9.0}}, {Numbers{8.0, 1.5, 0.1}}, true);
  EXPECT_EQ(flips.law, 0u);
  EXPECT_EQ(flips.other, 2u) << "further apart than the first and the second";
  const ColumnVerdict drifts = judged_column({Numbers{1.0, 5.0, 0.0001}}, {Numbers{1.05, 7.0, 0.0002}}, true);
  EXPECT_EQ(drifts.holding, Holding::drifts);
  EXPECT_EQ(drifts.law, 1u) << "the third moves by more, below a thousandth of the largest";
  EXPECT_EQ(judged_column({Numbers{1.0, 5.0}}, {Numbers{1.05, 5.1}}, true).law, 0u);
}

/// A flat tip of radius 0.5 mm in a plane, `z` its way, whose points are 0.4 mm apart: 5 of them lie within, and 21 of
/// those that are 0.2 mm apart, all more than 50 um from its side.
class FlatTip : public testing::Test {
 protected:
  static constexpr double kDepth = 2e-5;
  Json scene_ = {
      {"time", {{"step_s", 0.0005}, {"steps", 200}}},
      {"environment", {{"type", "plane"}, {"size_m", 0.004}, {"spacing_m", 0.0004}}},
      {"tool", {{"diameter_m", 0.001}, {"length_m", 0.01}, {"tip", "flat"}}},
      {"motion", {{"position", {{"type", "prescribed"}, {"x_m", 0}, {"y_m", 0}, {"z_m", -kDepth}}}}},
      {"rendering", {{"stiffness_N_per_m", 1000}, {"damping_N_s_per_m", 0}, {"virtual_coupling_N_per_m", 40'000}}}};

  /// Columns by what was halved.
  std::map<Finer, RankingColumn> checked(const std::vector<std::string>& algorithms, const std::string& metric) const {
    test::write_plainly(directory_ / "scene.json", scene_.dump());
    const BatchPlan plan =
        plan_batch({.scenarios = {directory_ / "scene.json"}, .algorithms = algorithms, .overrides = {}});
    const BatchReport report = run_batch(plan, {});
    const RankingCheck check = check_ranking(plan, make_league(league_runs(plan, report, {metric})), {});
    std::map<Finer, RankingColumn> columns;
    for (const RankingColumn& column : check.columns) columns[column.finer] = column;
    EXPECT_EQ(columns.size(), check.columns.size());
    return columns;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(FlatTip, FlipsWhereTwoStiffnessesCrossAsPointsGrowDenser) {
  // The 10/N rule is min(N, 10) springs stiff, and N springs in series with K_vc = 40 K are 40 N / (40 + N): 5 and
  // 4.44 for 5 points, 10 and 13.8 for 21.
  auto columns = checked({"mcneely", "virtual_coupling"}, "force_max_N");
  const RankingColumn& spacing = columns[Finer::spacing];
  EXPECT_EQ(spacing.verdict.holding, Holding::flips);
  EXPECT_EQ(spacing.best_before, 1u);
  EXPECT_EQ(spacing.best_after, 0u);
  const double one = 1000.0 * kDepth;  // [N]
  // Depths are differences of lengths of a millimetre: 1e-16 of these.
  EXPECT_NEAR(*spacing.before[0], 5.0 * one, 1e-12);
  EXPECT_NEAR(*spacing.after[0], 10.0 * one, 1e-12);
  EXPECT_NEAR(*spacing.before[1], 200.0 / 45.0 * one, 1e-12);
  EXPECT_NEAR(*spacing.after[1], 840.0 / 61.0 * one, 1e-12);
  EXPECT_EQ(spacing.change, "environment.spacing_m 0.4 mm -> 0.2 mm");
  // A finer step of a prescribed motion changes nothing, and that is said.
  EXPECT_EQ(columns[Finer::step].verdict.holding, Holding::holds);
  EXPECT_EQ(columns[Finer::step].before, columns[Finer::step].after);
  EXPECT_NE(columns[Finer::step].change.find("the motion is prescribed"), std::string::npos);
}

TEST_F(FlatTip, HoldsWhereTheStiffnessDoesNotDependOnThePoints) {
  for (const auto& [finer, column] : checked({"mean", "shaped_stiffness", "highest_depth"}, "force_max_N")) {
    EXPECT_EQ(column.verdict.holding, Holding::holds);
    // Shaping comes within a relative 1e-3 of K in its ten iterations.
    for (const auto& force : column.after) EXPECT_NEAR(*force, 1000.0 * kDepth, 1e-3 * 1000.0 * kDepth);
  }
}

TEST_F(FlatTip, MeasuresStepsOfTheForceAtTheSameTimes) {
  scene_["motion"]["position"]["z_m"] = {{"type", "sine"}, {"mean", -kDepth}, {"amplitude", 1e-5}, {"period_s", 0.05}};
  auto columns = checked({"mean"}, "force_step_max_N");
  // K 1e-5 2 pi / 0.05 s * 0.5 ms = 6.3e-4 N, and half of it between the rows of the finer step.
  EXPECT_NEAR(*columns[Finer::step].before[0], 6.28e-4, 0.01e-4);
  EXPECT_EQ(columns[Finer::step].before, columns[Finer::step].after);
}

TEST_F(FlatTip, KeepsDelaysAndSaysWhatCannotBeHalved) {
  scene_ = test::minimal_scenario("springs");
  scene_["device"] = {{"type", "impedance"}, {"handle_mass_kg", 0.1}, {"viscous_N_s_per_m", 1}, {"delay_samples", 1.5}};
  auto columns = checked({"mean"}, "force_max_N");
  EXPECT_EQ(columns[Finer::spacing].verdict.holding, Holding::unchecked);
  EXPECT_EQ(columns[Finer::spacing].change, "springs have no points");
  EXPECT_NE(columns[Finer::step].change.find(", device.delay_samples 1.5 -> 3"), std::string::npos)
      << columns[Finer::step].change;
  EXPECT_NE(columns[Finer::step].verdict.holding, Holding::unchecked);
}

}  // namespace
}  // namespace hapbench::ranking_check_test
