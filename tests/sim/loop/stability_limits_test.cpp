// Thesis A.3: stable while 4 - 2 B dt/M - K dt^2/M > 0. Runs a thousandth below and above each limit.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/contact/stiffness_tensor.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::stability_limits_test {
namespace {

constexpr double kMass = 0.1, kStep = 0.0005;
constexpr double kMargin = 1e-3;
// Above a limit by the margin the slowest of the cases below grows by 1.7e-3 a step (the root of the characteristic
// polynomial beyond -1), so in this many steps by exp(34): far past the bounds. Below, it decays or stays.
constexpr std::uint64_t kSteps = 20000;

/// A run of the tool from rest 1 mm along (1, 1, 1) on bilateral springs that are all added up.
Outcome run(const std::vector<Vec3>& gradients, double K, double B, const Vec3& velocity = Vec3::Zero()) {
  test::Setting setting;
  setting.springs = SpringSet{gradients, true};
  setting.pose.position = Vec3::Constant(0.001);
  RenderingConfig config;
  config.algorithm = "summation";
  config.stiffness = K;
  config.damping = B;
  config.mass = kMass;
  SimulationConfig simulation = test::free_run_config(setting, config, kSteps);
  simulation.dt = kStep;
  simulation.velocity = velocity;
  // Without a spring the displacement grows as a sum of velocities, so both get the same bound. The undamped spring
  // swings up to sqrt((1 + q) / (1 - q)) = 63 times its start just below the limit, where q = 1 - margin / 2.
  simulation.bounds = {1.0, 1e3, 1e12};
  return Simulation(simulation, test::free_run(setting, config), {}).run().outcome;
}

double damping_at_ratio(double zeta, double K) {
  return 2 * zeta * std::sqrt(K * kMass);
}

TEST(StabilityLimits, UndampedSpringIsStableUpTo4MOverDt2) {
  const double K_max = 4 * kMass / (kStep * kStep);
  EXPECT_NEAR(K_max, 1.6e6, 1e-6);
  EXPECT_EQ(run({Vec3::UnitX()}, K_max * (1 - kMargin), 0.0), Outcome::completes);
  EXPECT_EQ(run({Vec3::UnitX()}, K_max * (1 + kMargin), 0.0), Outcome::diverges);
}

TEST(StabilityLimits, DamperAloneIsStableUpTo2MOverDt) {
  const double B_max = 2 * kMass / kStep;
  EXPECT_NEAR(B_max, 400.0, 1e-9);
  EXPECT_EQ(run({Vec3::UnitX()}, 0.0, B_max * (1 - kMargin), Vec3::UnitX()), Outcome::completes);
  EXPECT_EQ(run({Vec3::UnitX()}, 0.0, B_max * (1 + kMargin), Vec3::UnitX()), Outcome::diverges);
}

TEST(StabilityLimits, SpringDamperOfRatio07IsStableUpToTheThesisValues) {
  const double zeta = 0.7;
  const double K_max = kMass * std::pow(2 * (std::sqrt(1 + zeta * zeta) - zeta) / kStep, 2);
  EXPECT_EQ(std::floor(K_max), 433731);
  EXPECT_NEAR(damping_at_ratio(zeta, K_max), 291.6, 0.05);
  for (const double side : {-1.0, 1.0}) {
    const double K = K_max * (1 + side * kMargin);
    EXPECT_EQ(run({Vec3::UnitX()}, K, damping_at_ratio(zeta, K)), side < 0 ? Outcome::completes : Outcome::diverges);
  }
}

TEST(StabilityLimits, ParallelSpringsShareTheLimit) {
  const std::vector<Vec3> five(5, Vec3::UnitY());
  const double K_max = 4 * kMass / (kStep * kStep) / 5;
  EXPECT_EQ(run(five, K_max * (1 - kMargin), 0.0), Outcome::completes);
  EXPECT_EQ(run(five, K_max * (1 + kMargin), 0.0), Outcome::diverges);
}

TEST(StabilityLimits, SpringsInAllDirectionsAreGovernedByLambdaMax) {
  Random random(1);
  for (int i = 0; i < 3; ++i) {
    std::vector<Vec3> gradients(7);
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer contacts = test::contacts_of(gradients);
    for (std::size_t j = 0; j < gradients.size(); ++j) contacts.weight[j] = 1.0;
    const double lambda = lambda_max(stiffness_tensor(contacts));

    // K and B both times lambda_max(S): 4 - 2 lambda B dt/M - lambda K dt^2/M > 0 for B = K tau.
    const double tau = 1e-4;
    const double K_max = 4 * kMass / (lambda * (2 * tau * kStep + kStep * kStep));
    for (const double side : {-1.0, 1.0}) {
      const double K = K_max * (1 + side * kMargin);
      EXPECT_EQ(run(gradients, K, K * tau), side < 0 ? Outcome::completes : Outcome::diverges) << "set " << i;
    }
  }
}

}  // namespace
}  // namespace hapbench::stability_limits_test
