#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/run/run_scenario.hpp"

/// The planar peg in its hole (thesis A.1, Fig. A.2): the original algorithm vibrates, the shaped one is smooth.
namespace hapbench::peg_in_hole_test {
namespace {

RunReport report_of(const std::string& scenario) {
  return run_scenario(load_scenario(find_scenario(scenario)), std::nullopt, false);
}

TEST(PegInHole, VibratesFiveTimesLessWithShapedStiffness) {
  const Metrics original = report_of("peg_in_hole_2d_original_averaging").summary.metrics;
  for (const char* shaped : {"peg_in_hole_2d_shaped_stiffness", "peg_in_hole_2d_exact_shaping"}) {
    const Metrics smooth = report_of(shaped).summary.metrics;
    EXPECT_GE(original.velocity_total_variation, 5.0 * smooth.velocity_total_variation) << shaped;
    // The original run is the shorter one, so that a step of it is rougher still.
    EXPECT_LT(original.rows, smooth.rows) << shaped;
    EXPECT_GE(*original.vibration_power, 25.0 * *smooth.vibration_power) << shaped;  // power goes with the square
    EXPECT_GT(original.force_reversals, 5 * smooth.force_reversals) << shaped;
  }
}

TEST(PegInHole, IsSteeredOutOfTheHoleByItsTilt) {
  for (const char* scenario : {"peg_in_hole_2d_shaped_stiffness", "peg_in_hole_2d_exact_shaping"}) {
    const RunSummary run = report_of(scenario).summary;
    EXPECT_EQ(run.result.outcome, Outcome::leaves_hole) << scenario;
    // 1.2 rad/s from 0.1 rad: horizontal, at pi / 2, only after 1.2 s.
    EXPECT_LT(run.duration, 1.2) << scenario;
    EXPECT_GT(run.metrics.final_position.y(), 0.0) << scenario;
  }
}

TEST(PegInHole, StaysInItsPlane) {
  for (const BundledScenario& bundled : bundled_scenarios()) {
    if (bundled.name.find("peg_in_hole_2d") != 0) continue;
    EXPECT_EQ(report_of(bundled.name).summary.metrics.final_position.z(), 0.0) << bundled.name;
  }
}

TEST(PegInHole, KeepsItsRatiosWithinTheProvenBoundUnderExactShaping) {
  // The bounds of exact_shaping.hpp: lambda_max(S) <= (1 + sqrt 2) / 2 in the plane, with it every ratio; a ratio is at
  // least 1 - 1e-6 c_i, and c_i <= sum c = tr S <= sqrt 2 ||S||_F <= sqrt 2 ||I||_F = 2; half as much again for
  // rounding.
  const Metrics metrics = report_of("peg_in_hole_2d_exact_shaping").summary.metrics;
  ASSERT_TRUE(metrics.ratio);
  EXPECT_LE(metrics.ratio->max, (1.0 + std::sqrt(2.0)) / 2.0);
  EXPECT_GE(metrics.ratio->min, 1.0 - 3e-6);
}

}  // namespace
}  // namespace hapbench::peg_in_hole_test
