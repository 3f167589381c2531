#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Ten minutes in contact, against the closed form of where they end.
namespace hapbench::ten_minutes_test {
namespace {

/// Steady response x_k of the integrator's spring-damper, (M/dt²)(x_(k+1) - 2 x_k + x_(k-1)) + (B/dt)(x_k - x_(k-1)) +
/// K x_k = F_k, to F_k = mean + amplitude sin(w k dt): a geometric sequence answers a geometric sequence.
double steady_response(double K, double B, double M, double dt, const Profile::Sine& force, double k) {
  const double angle = 2.0 * std::numbers::pi / force.period_s * dt;
  const std::complex<double> z = std::polar(1.0, angle);
  const std::complex<double> dynamic_stiffness = (M / (dt * dt)) * (z - 2.0 + 1.0 / z) + (B / dt) * (1.0 - 1.0 / z) + K;
  return force.mean / K + (force.amplitude * std::polar(1.0, angle * k) / dynamic_stiffness).imag();
}

TEST(TenMinutesInContact, EndWhereTheClosedFormSaysAndMakeNoEnergy) {
  const LoadedScenario loaded = load_scenario(find_scenario("ten_minutes_in_contact"));
  const Scenario& scenario = loaded.scenario;
  const RunReport report = run_scenario(loaded, std::nullopt, false);
  EXPECT_EQ(report.unmet, std::vector<std::string>{});
  EXPECT_EQ(report.summary.result.rows, 1'200'000u);

  const double K = scenario.rendering.stiffness, M = scenario.rendering.mass;
  const double B = 2.0 * scenario.rendering.damping_ratio * std::sqrt(K * M);
  const auto& force = std::get<Profile::Sine>(std::get<ForceHandFields>(scenario.hand).force[2].shape());
  const double expected = steady_response(K, B, M, scenario.time.step, force, 1'199'999.0);
  // The transient is gone, e^(-100 000). Rounding of position and force, 1e-16 of 0.3 mm each, is forgotten within a
  // hundred steps; the phase of the sine, 5386 rad, is known to 1e-12, which is 1e-12 of its 0.05 mm.
  EXPECT_NEAR(report.summary.metrics.final_position.z(), expected, 1e-15);
  const auto& bound = scenario.expect.metrics.at("final_position_m.z");
  EXPECT_NEAR(0.5 * (*bound.min + *bound.max), expected, 1e-14) << "the file's bounds are about the closed form";

  // Energy made in a step is the rounding of the ledger's sums of terms up to 3 mJ: 1e-18 J, 1.2 million times.
  EXPECT_LE(metric_of(report.summary, "energy.created_sum_J").value(), 1.2e-12);
}

}  // namespace
}  // namespace hapbench::ten_minutes_test
