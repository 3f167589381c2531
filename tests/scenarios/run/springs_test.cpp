#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"

/// Bundled scenarios of bilateral springs against the linear recurrence they are: one spring-damper under the
/// integrator is (x, v) <- A (x, v) with the matrix A of Eq. A.2.
namespace hapbench::springs_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct State {
  double x, v;
};

/// The right-hand side of Eq. A.2, in the order in which the thesis prints it.
State after_one_step(const State& s, double K, double B, double M, double dt) {
  return {(1.0 - K * dt * dt / M) * s.x + (dt - B * dt * dt / M) * s.v, -K * dt / M * s.x + (1.0 - B * dt / M) * s.v};
}

/// Rows of a run.
class Rows final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override { rows.push_back(record); }
  std::vector<StepRecord> rows;
};

std::vector<StepRecord> rows_of(const std::string& scenario, const std::vector<std::string>& overrides) {
  const LoadedScenario loaded = load_scenario(find_scenario(scenario), overrides);
  Rows rows;
  Simulation(simulation_config(loaded.scenario), assemble(loaded.scenario), {&rows}).run();
  return rows.rows;
}

TEST(OneSpringDamper, FollowsEquationA2ToRounding) {
  const double K = 20000.0, M = 0.1, dt = 0.0005, B = 2.0 * 0.7 * std::sqrt(K * M);
  const auto rows = rows_of("single_spring", {"time.steps=2000", "initial.velocity_m_per_s=[0.5,0,0]"});
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

TEST(OneUndampedSpring, SwingsForEverAsTheClosedFormSays) {
  // x_(k+1) = (2 - kappa) x_k - x_(k-1) with x_1 = (1 - kappa) x_0: a sampled cosine of 2 cos theta = 2 - kappa.
  const double K = 1.59e6, M = 0.1, dt = 0.0005, kappa = K * dt * dt / M, x0 = 1e-3;
  const double cosine = 1.0 - kappa / 2.0, theta = std::acos(cosine), sine = std::sqrt(1.0 - cosine * cosine);
  const auto rows = rows_of("single_spring_undamped", {});
  ASSERT_EQ(rows.size(), 2000u);
  const double amplitude = x0 * (1.0 + (1.0 - kappa - cosine) / sine);
  // Roundings of some eps of the amplitude a step add up over the steps and are amplified by 1 / sine; theta, known to
  // eps / sine, is multiplied by k.
  const double tolerance = 2000 * 8 * kEpsilon / sine * std::abs(amplitude);
  double largest = 0.0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double angle = static_cast<double>(k) * theta;
    const double expected = x0 * (std::cos(angle) + (1.0 - kappa - cosine) / sine * std::sin(angle));
    ASSERT_NEAR(rows[k].tool.pose.position.x(), expected, tolerance) << k;
    largest = std::max(largest, std::abs(rows[k].tool.pose.position.x()));
  }
  EXPECT_GT(largest, 0.9 * std::abs(amplitude));
}

TEST(ShapedSpringsOfTableA3, ActAsOneSpringDamperAlongEachAxis) {
  const double K = 20000.0, M = 0.2, dt = 0.0005, B = 2.0 * 0.7 * std::sqrt(K * M);
  const auto rows = rows_of("springs_unlimited_shaped_stiffness", {});
  ASSERT_EQ(rows.size(), 2000u);
  Mat3 identity_in_plane = Mat3::Zero();
  identity_in_plane.diagonal() << 1.0, 1.0, 0.0;
  // 200 equal weights are summed, so that S is off by at most some 200 eps; K and B with it.
  const double S_tolerance = 256 * kEpsilon;
  // As above with the error of S in place of eps; rho = sqrt(1 - B dt / M) = 0.88, so that k rho^k stays below 3.
  const double x_tolerance = 8 * 3 * 4 * 256 * kEpsilon * 5e-3, v_tolerance = x_tolerance / dt;
  State x{-0.005, 0.0}, y{-0.005, 0.0};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_LE((rows[k].force.S - identity_in_plane).cwiseAbs().maxCoeff(), S_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.pose.position.x(), x.x, x_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.pose.position.y(), y.x, x_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.velocity.x(), x.v, v_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.velocity.y(), y.v, v_tolerance) << k;
    x = after_one_step(x, K, B, M, dt);
    y = after_one_step(y, K, B, M, dt);
  }
}

TEST(UnsignedSpringsOfTableA3, ReachTheOriginUnderTheOriginalAlgorithmToo) {
  // Thesis A.2: every algorithm arrives. With signed depths the gradients of opposite springs cancel and leave the ten
  // upward ones, 100 times too soft along x: the tool stays where it was.
  const auto x_at_end = [](const char* is_signed) {
    const auto rows = rows_of("springs_unlimited_original_averaging", {std::string("environment.signed=") + is_signed});
    return std::abs(rows.back().tool.pose.position.x());
  };
  EXPECT_EQ(x_at_end("true"), 0.005);
  EXPECT_LT(x_at_end("false"), 0.0005);
}

TEST(SummedSpringsOfTableA3, AreTooStiffForTheTimeStep) {
  // 200 springs along x: lambda K = 4e6 N/m and lambda B = 17.7e3 N s/m, far beyond 4 M / dt^2 = 3.2e6 and 2 M / dt =
  // 800.
  const LoadedScenario loaded = load_scenario(find_scenario("springs_unlimited_summation"));
  Simulation simulation(simulation_config(loaded.scenario), assemble(loaded.scenario), {});
  EXPECT_EQ(simulation.run().outcome, Outcome::diverges);
}

}  // namespace
}  // namespace hapbench::springs_test
