#include "scenarios/analysis/convergence/finer_runs.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/analysis/convergence/significant_order.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::finer_runs_test {
namespace {

/// Checks two laws whose stiffnesses cross as the points get denser. A flat tip of radius 0.5 mm in a plane touches 5
/// points at a spacing of 0.4 mm, 21 points at 0.2 mm and 69 points at 0.1 mm. With N points in contact, `mcneely` (the
/// 10/N rule) renders a stiffness of min(N, 10) K. `virtual_coupling` renders N springs in series with K_vc = 40 K, a
/// stiffness of 40 N / (40 + N) K. So the stiffnesses of the two laws are 5 K and 4.44 K for 5 points, 10 K and 13.8 K
/// for 21 points, 10 K and 25.3 K for 69 points.
TEST(FinerRuns, LeaveNoOrderWhereTwoStiffnessesCrossAsPointsGrowDenser) {
  constexpr double kDepth = 2e-5, kOne = 1000.0 * kDepth;  // depth [m], force of one spring [N]
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
  EXPECT_EQ(significant_order_text(numbers, laws), "no significant order: virtual_coupling ~ mcneely");
  EXPECT_NEAR(*numbers[0].value, 5.0 * kOne, 1e-12);
  // No order is observed. The error is then the largest difference between two levels, plus at most the same amount for
  // the unknown error of the finest level.
  EXPECT_GE(*known[0].spacing, 5.0 * kOne - 1e-9);
  EXPECT_LE(*known[0].spacing, 10.0 * kOne);
  EXPECT_GE(*known[1].spacing, (25.3 - 4.45) * kOne);
  EXPECT_EQ(known[0].step, 0.0) << "the motion is prescribed";
  EXPECT_EQ(finer.refined(0), "time.step_s 0.0005, 0.00025, 0.000125; environment.spacing_m 0.0004, 0.0002, 0.0001");
}

/// Checks the error of the largest speed of a drill that is pushed onto a plane. The largest speed is the speed in the
/// last step before the landing. Between the first levels this speed changes by 2e-6 m/s. Between the next levels it
/// changes by 5e-4 m/s, because the landing moves to another step.
TEST(FinerRuns, ErrorOfAnExtremeHoldsTheValuesOfFinerLevels) {
  const std::vector<std::string> laws = {"mean"};
  const Comparison comparison = planned({.scenarios = {find_scenario("poke_plane")}, .algorithms = laws});
  const std::vector<Result> reports = run_all(comparison.scenes, {});
  const FinerRuns finer(comparison, reports, {});
  for (const char* metric : {"speed_max_m_per_s", "landing_force_max_N", "force_max_N"}) {
    const double value = *number_of(reports[0].metrics, metric);
    const KnownError known = finer.known_error(0, metric);
    const LevelSweep levels = level_sweep(comparison.scenes[0].load(0), kStepPath, 6, 2.0);
    const Cases cases = finer_cases(levels, comparison.scenes[0]);
    const std::vector<Result> runs = run_all({&cases, 1}, {});
    for (const Result& run : runs) EXPECT_NEAR(*number_of(run.metrics, metric), value, *known.step) << metric;
  }
}

}  // namespace
}  // namespace hapbench::finer_runs_test
