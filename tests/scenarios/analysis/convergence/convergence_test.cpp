#include "scenarios/analysis/convergence/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/run_all.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Observed orders of sequences whose order is known, and of such as have none; levels of scenes, and scenes that have
/// no order. Roache's formulas on a recurrence are in tests/known_answers.
namespace hapbench::convergence_test {
namespace {

/// Levels h = 1, 1/r, … of a result f(h).
std::vector<LevelResult> levels_of(const std::function<double(double)>& f, std::size_t count = 5, double ratio = 2.0) {
  std::vector<LevelResult> levels;
  double h = 1.0;
  for (std::size_t i = 0; i < count; ++i, h /= ratio)
    levels.push_back({"h = " + std::to_string(h), "completes", f(h), {}, i});
  return levels;
}

std::vector<LevelResult> levels_with(const std::vector<double>& results) {
  std::vector<LevelResult> levels;
  for (const double result : results)
    levels.push_back({"level " + std::to_string(levels.size()), "completes", result, {}, levels.size()});
  return levels;
}

Convergence judged(const std::vector<LevelResult>& levels, double formal_order, double ratio = 2.0) {
  return convergence_of({{}, ratio, formal_order}, levels);
}

/// No order, for a reason with these words; and then none of the numbers that only an order gives.
void expect_no_order(const Convergence& c, const std::string& said) {
  EXPECT_NE(c.reason.find(said), std::string::npos) << c.reason;
  EXPECT_FALSE(c.order || c.extrapolated || c.gci || c.asymptotic) << c.reason;
}

TEST(ObservedOrder, IsThatOfAPureErrorTerm) {
  for (const double p : {0.5, 1.0, 2.0, 4.0}) {
    for (const double ratio : {1.5, 2.0, 10.0}) {
      const Convergence c =
          judged(levels_of([p](double h) { return 3.0 - 0.25 * std::pow(h, p); }, 3, ratio), 4.0, ratio);
      ASSERT_TRUE(c.order) << p << " " << ratio << ": " << c.reason;
      // The differences are known to 3 * 2.2e-16 * 2; the smallest of them is 0.25 (10^-1 - 10^-2)^... = 2e-9 at p = 4.
      EXPECT_NEAR(*c.order, p, 1e-6);
      EXPECT_NEAR(*c.extrapolated, 3.0, 1e-13);
      // The error of the finest level, with Roache's factor.
      const double error = 0.25 * std::pow(ratio, -2.0 * p);
      EXPECT_NEAR(*c.gci, 1.25 * error / (3.0 - error), 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.back(), 1.25 * error, 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.front(), 1.25 * 0.25, 1e-12);
    }
  }
}

TEST(ObservedOrder, IsAsymptoticWhereTheIndicesAgreeWithinATenth) {
  EXPECT_TRUE(judged(levels_with({1.5, 1.1, 1.0}), 2.0).asymptotic) << "f_3 / f_2 = 1 / 1.1";
  EXPECT_FALSE(judged(levels_with({1.6, 1.2, 1.0}), 2.0).asymptotic) << "1 / 1.2";
}

TEST(ObservedOrder, IsNotStatedWhereTheDifferencesShowNone) {
  const double ulp = std::nextafter(1.0, 2.0) - 1.0;
  const std::pair<std::vector<double>, const char*> kCases[] = {
      {{1.0, 1.2, 1.1, 1.15, 1.125}, "change their sign"},
      {{2.0, 1.0, 1.4, 1.2, 1.1}, "change their sign"},  // the last three alone would have order 1
      {{1.0, 1.1, 1.3, 1.7}, "do not shrink"},
      {{1.0, 1.1, 1.2, 1.3}, "do not shrink"},
      {{1.0, 1.01, 1.2, 1.344}, "do not shrink"},  // the last three alone would have order 0.4
      {{2.0, 1.125, 1.015625, 1.001953125}, "more than twice the formal one, 1"},
      {{2.0, 2.0, 2.0}, "rounding"},
      {{0.0, 0.0, 0.0}, "rounding"},
      {{1.1, 1.0 + 16 * ulp, 1.0 + 4 * ulp, 1.0 + 2 * ulp, 1.0 + ulp}, "rounding"},
      {{1.0, 2.0, 2.0, 3.0, 3.5}, "some of the last levels"}};
  for (const auto& [results, said] : kCases) expect_no_order(judged(levels_with(results), 1.0), said);
}

TEST(ObservedOrder, IsNotStatedWhereContactsSwitch) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  for (LevelResult& level : levels) level.contacts = {{"landings", 1.0}, {"colliding_mean", 21.0}};
  levels[1].contacts[1].second = 22.0;
  EXPECT_TRUE(judged(levels, 1.0).order) << "the coarse levels do not count";
  levels[4].contacts[1].second = 21.5;
  const Convergence c = judged(levels, 1.0);
  expect_no_order(c, "contacts switch between the last levels (colliding_mean is 21 at");
  EXPECT_EQ(c.band, std::pair(1.0625, 1.25));
  EXPECT_NEAR(*c.errors[0], 1.0 - 0.0625, 1e-12);
}

TEST(ObservedOrder, CountsLevelsThatEndAsTheFinest) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  levels[0] = {"h = 1", "diverges", std::nullopt};
  levels[1].outcome = "went_through";
  const Convergence c = judged(levels, 1.0);
  ASSERT_TRUE(c.order) << c.reason;
  EXPECT_NEAR(*c.extrapolated, 1.0, 1e-12);
  EXPECT_FALSE(c.errors[0] || c.errors[1] || !c.errors[2]);
  levels[2].result.reset();
  const Convergence two = judged(levels, 1.0);
  expect_no_order(two, "the run at h = 0.250000 has no value of the metric (completes), which leaves 2 levels");
  EXPECT_EQ(two.band, std::pair(1.0625, 1.125));
  levels[4].outcome = "stuck";
  expect_no_order(judged(levels, 1.0), "ends with completes, which leaves 1 levels");
  EXPECT_FALSE(judged(levels, 1.0).band);
  levels[4].result.reset();
  const Convergence none = judged(levels, 1.0);
  expect_no_order(none, "the finest run, at h = 0.062500, has no value of the metric (stuck)");
  for (const auto& error : none.errors) EXPECT_FALSE(error);
  expect_no_order(judged(levels_with({1.0, 2.0}), 1.0), "2 levels are fewer than three");
}

struct Study {
  LevelSweep levels;
  std::vector<Result> runs;

  std::vector<LevelResult> levels_of(const std::string& metric) const {
    std::vector<LevelResult> results;
    for (std::size_t i = 0; i < runs.size(); ++i) results.push_back(level_result(levels, i, runs[i], metric));
    return results;
  }
  Convergence of(const std::string& metric) const { return convergence_of(levels, levels_of(metric)); }
};

Study studied(const Json& json, std::size_t count = 5, const std::string& path = kStepPath) {
  const ScenarioText scenario{test::data_directory() / "converge.json", json};
  LevelSweep levels = level_sweep(load_scenario(scenario, {}), path, count, 2.0);
  const Cases cases({scenario}, {}, {levels.axis});
  return {std::move(levels), run_all({&cases, 1}, {})};
}

constexpr double kStep = 1e-3, kStiffness = 1000.0, kMass = 0.1, kStart = 1e-3;
constexpr int kSteps = 40;

/// A mass on one spring that holds from both sides.
Json spring(double zeta, const char* integrator) {
  return {{"time", {{"step_s", kStep}, {"steps", kSteps}}},
          {"environment", {{"type", "springs"}, {"groups", {{{"direction", {1, 0, 0}}, {"count", 1}}}}}},
          {"initial", {{"position_m", {kStart, 0, 0}}}},
          {"integrator", {{"type", integrator}}},
          {"rendering",
           {{"algorithm", "summation"},
            {"stiffness_N_per_m", kStiffness},
            {"mass_kg", kMass},
            {"damping_ratio", zeta},
            {"friction", {{"mu_s_N_s_per_m", 0}, {"mu_f_s_per_m", 0}}}}}};
}

TEST(Converge, KnowsTheFormalOrderOfEveryIntegrator) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double zeta : {0.0, 0.2}) {
      const ScenarioText scenario{"x.json", spring(zeta, integrator->info.name)};
      EXPECT_EQ(level_sweep(load_scenario(scenario, {}), kStepPath, 3, 2.0).formal_order,
                zeta > 0.0 ? integrator->damped_order : integrator->order)
          << integrator->info.name << " " << zeta;
    }
  }
}

/// All levels are measured at the same times: a prescribed motion gives the same force steps, whatever the step, and
/// none that a quarter of the step makes a quarter of.
TEST(Converge, MeasuresAtTheTimesOfTheCoarsestRows) {
  Json scene = spring(0.2, "leapfrog");
  scene["motion"] = {{"position",
                      {{"type", "prescribed"},
                       {"x_m", {{"type", "sine"}, {"mean", 0}, {"amplitude", 1e-3}, {"period_s", 0.013}}},
                       {"y_m", 0},
                       {"z_m", 0}}}};
  scene["rendering"]["damping_ratio"] = 0;
  const Study study = studied(scene);
  for (const char* metric : {"force_max_N", "force_step_max_N", "force_reversals"}) {
    const auto levels = study.levels_of(metric);
    const double first = *levels.front().result;
    // Times are products of two roundings each, over a period of 2 pi 1e-3 m.
    for (const LevelResult& level : levels) EXPECT_NEAR(*level.result, first, 1e-12 * first) << metric;
    EXPECT_NE(study.of(metric).reason.find("rounding"), std::string::npos) << study.of(metric).reason;
  }
  EXPECT_EQ(study.runs[4].end.rows, 16u * kSteps);
}

TEST(Converge, KeepsTheLengthOfDelays) {
  Json scene = spring(0.2, "leapfrog");
  scene["device"] = {{"type", "impedance"}, {"handle_mass_kg", 0.1}, {"delay_samples", 1.5}};
  const LevelSweep levels = level_sweep(load_scenario(ScenarioText{"x.json", scene}, {}), kStepPath, 3, 2.0);
  EXPECT_EQ(levels.axis.values, (std::vector<std::string>{"0.001", "0.0005", "0.00025"}));
  EXPECT_EQ(levels.axis.along[2].stride, 4);
  EXPECT_EQ(levels.axis.along[2].overrides, (std::vector<std::string>{"time.steps=160", "device.delay_samples=6"}));
  EXPECT_EQ(levels.formal_order, 1.0);
}

TEST(HeldOrder, SaysWhatHoldsAndOfWhatNoErrorIsKnown) {
  const auto says = [](const std::vector<NumberWithError>& numbers) {
    const std::vector<std::string> names = {"a", "b", "c", "d"};
    return held_text(numbers, names);
  };
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}}), "the order holds: b < a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 1.0}}), "no order holds: b ~ a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {2.1, 0.1}, {9.0, std::nullopt}}),
            "the order holds in part: b < a ~ c; no error is known of d");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {1.5, 7.0}}), "the order holds in part: b < a; too uncertain for a place: c");
  EXPECT_EQ(says({{1.0, 0.1}, {1.5, 0.6}, {3.0, 0.1}}), "the order holds in part: a ~ b < c");
  EXPECT_EQ(says({{1.0, 0.0}, {1.0 + 1e-12, 0.0}}), "no order holds: a ~ b") << "rounding is no difference";
  EXPECT_EQ(says({{std::nullopt, 0.1}, {1.0, 0.1}}), "there is nothing to compare");
}

/// A flat tip of radius 0.5 mm in a plane whose points are 0.4 mm apart: 5 of them lie within, 21 of those that are
/// 0.2 mm apart and 69 at 0.1 mm. The 10/N rule is min(N, 10) springs stiff, and N springs in series with K_vc = 40 K
/// are 40 N / (40 + N): 5 and 4.44 for 5 points, 10 and 13.8 for 21, 10 and 25.3 for 69.
TEST(FinerRuns, LeaveNoOrderWhereTwoStiffnessesCrossAsPointsGrowDenser) {
  constexpr double kDepth = 2e-5, kOne = 1000.0 * kDepth;  // [m], [N]
  const Json scene = {
      {"time", {{"step_s", 0.0005}, {"steps", 200}}},
      {"environment", {{"type", "plane"}, {"size_m", 0.004}, {"spacing_m", 0.0004}}},
      {"tool", {{"diameter_m", 0.001}, {"length_m", 0.01}, {"tip", "flat"}}},
      {"motion", {{"position", {{"type", "prescribed"}, {"x_m", 0}, {"y_m", 0}, {"z_m", -kDepth}}}}},
      {"rendering", {{"stiffness_N_per_m", 1000}, {"damping_N_s_per_m", 0}, {"virtual_coupling_N_per_m", 40'000}}}};
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "scene.json", scene.dump());
  const std::vector<std::string> laws = {"mcneely", "virtual_coupling"};
  const Comparison comparison = planned({.scenarios = {directory / "scene.json"}, .algorithms = laws});
  const std::vector<Result> reports = run_all(comparison.scenes, {});
  const FinerRuns finer(comparison, reports, {});
  std::vector<KnownError> known;
  std::vector<NumberWithError> numbers;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    known.push_back(finer.known_error(i, "force_max_N"));
    numbers.push_back({number_of(reports[i].metrics, "force_max_N"), known.back().sum()});
  }
  EXPECT_EQ(held_text(numbers, laws), "no order holds: virtual_coupling ~ mcneely");
  EXPECT_NEAR(*numbers[0].value, 5.0 * kOne, 1e-12);
  EXPECT_NEAR(*known[0].spacing, 5.0 * kOne, 1e-9) << "the plain difference: no order is seen";
  EXPECT_GE(*known[1].spacing, (25.3 - 4.45) * kOne);
  EXPECT_EQ(known[0].step, 0.0) << "the motion is prescribed";
  EXPECT_EQ(finer.refined(0), "time.step_s 0.0005, 0.00025, 0.000125; environment.spacing_m 4e-04, 2e-04, 1e-04");
}

}  // namespace
}  // namespace hapbench::convergence_test
