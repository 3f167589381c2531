#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "scenarios/run/run_scenario.hpp"
#include "tests/scenarios/support/bundled.hpp"

/// Bundled scenarios against closed forms: bilateral springs against the linear recurrence that they are (one
/// spring-damper under the integrator is (x, v) <- A (x, v) with the matrix A of Eq. A.2), and ten minutes in contact.
namespace hapbench::closed_forms_test {
namespace {

using test::bundled;
using test::rows_of;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct State {
  double x, v;
};

/// The right-hand side of Eq. A.2, in the order in which the thesis prints it.
State after_one_step(const State& s, double K, double B, double M, double dt) {
  return {(1.0 - K * dt * dt / M) * s.x + (dt - B * dt * dt / M) * s.v, -K * dt / M * s.x + (1.0 - B * dt / M) * s.v};
}

TEST(OneSpringDamper, FollowsEquationA2ToRounding) {
  const double K = 20000.0, M = 0.1, dt = 0.0005, B = 2.0 * 0.7 * std::sqrt(K * M);
  const auto rows = rows_of(bundled("single_spring", {"time.steps=2000", "initial.velocity_m_per_s=[0.5,0,0]"}));
  ASSERT_EQ(rows.size(), 2000u);
  State expected{1e-3, 0.5};
  // Each step either side makes a handful of roundings of the current state; with the modulus rho = sqrt(1 - B dt / M)
  // = 0.83 of the eigenvalues an error made k steps ago is worth k rho^k of it, at most 2. A factor of 4 is for powers
  // of A being larger than those of its eigenvalues. In all 8 * 2 * 4 units of the largest state.
  const double x_tolerance = 64 * kEpsilon * 1e-3, v_tolerance = 64 * kEpsilon * 1e-3 / dt;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_NEAR(rows[k].tool.pose.position.x(), expected.x, x_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.velocity.x(), expected.v, v_tolerance) << k;
    ASSERT_EQ(rows[k].tool.pose.position.tail<2>(), Eigen::Vector2d::Zero()) << k;
    expected = after_one_step(expected, K, B, M, dt);
  }
  EXPECT_LT(std::abs(expected.x), 1e-100);  // and comes to rest
}

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
  const Result report = run_scenario(loaded, std::nullopt, false);
  EXPECT_EQ(report.unmet, std::vector<std::string>{});
  EXPECT_EQ(report.end.rows, 1'200'000u);

  const double K = scenario.rendering.stiffness, M = scenario.rendering.mass;
  const double B = 2.0 * scenario.rendering.damping_ratio * std::sqrt(K * M);
  const auto& force = std::get<Profile::Sine>(std::get<ForceHandFields>(scenario.hand).force[2].shape());
  const double expected = steady_response(K, B, M, scenario.time.step, force, 1'199'999.0);
  // The transient is gone, e^(-100 000). Rounding of position and force, 1e-16 of 0.3 mm each, is forgotten within a
  // hundred steps; the phase of the sine, 5386 rad, is known to 1e-12, which is 1e-12 of its 0.05 mm.
  EXPECT_NEAR(number_of(report.metrics, "final_position_m.z").value(), expected, 1e-15);
  const auto& bound = scenario.expect.metrics.at("final_position_m.z");
  EXPECT_NEAR(0.5 * (*bound.min + *bound.max), expected, 1e-14) << "the file's bounds are about the closed form";

  // Energy made in a step is the rounding of the ledger's sums of terms up to 3 mJ: 1e-18 J, 1.2 million times.
  EXPECT_LE(number_of(report.metrics, "energy.created_sum_J").value(), 1.2e-12);
}

}  // namespace
}  // namespace hapbench::closed_forms_test
