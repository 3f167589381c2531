#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/integrators/spring_damper.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/setting.hpp"

/// Whatever a row of the table says is true of its integrator.
namespace hapbench::stability_test {
namespace {

TEST(IntegratorTable, HasUniqueNames) {
  std::set<std::string> names;
  for (const IntegratorEntry* entry : kIntegrators) {
    EXPECT_TRUE(names.insert(entry->info.name).second) << entry->info.name;
    EXPECT_NE(entry->make({}), nullptr) << entry->info.name;
  }
}

TEST(IntegratorTable, DocumentsEveryRow) {
  for (const IntegratorEntry* entry : kIntegrators) {
    const ModelInfo& info = entry->info;
    for (const char* text : {info.name, info.summary, info.formula, info.source, info.known_failure}) {
      ASSERT_NE(text, nullptr);
      EXPECT_FALSE(std::string(text).empty()) << info.name;
    }
  }
}

/// Calls check(system) with random spring-dampers on either side of the stability limits.
template <class Check>
void for_random_systems(const IntegratorEntry* integrator, Check check) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    SpringDamper system{random.uniform(0.0, 4e6), random.uniform(0.0, 1e3), 0.1, 0.0005, random.uniform(0.5, 2.0)};
    if (i % 5 == 0) system.B = 0.0;
    if (i % 5 == 1) system.K = 0.0;
    system.integrator = integrator;
    check(system);
  }
}

TEST(IntegratorTable, StepMatricesInClosedFormAreThoseOfTheIntegrators) {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->step_matrix == nullptr) continue;
    IntegratorEntry plain = *entry;
    plain.step_matrix = nullptr;  // the matrix is then built from the integrator
    for_random_systems(entry, [&](SpringDamper system) {
      const Eigen::Matrix2d closed = system.step_matrix();
      system.integrator = &plain;
      EXPECT_LE((closed - system.step_matrix()).norm(), 1e-14 * closed.norm()) << entry->info.name;
    });
  }
}

TEST(IntegratorTable, MarginsArePositiveExactlyWhereAStepIsStable) {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->stability_margin == nullptr) continue;
    for_random_systems(entry, [&](const SpringDamper& system) {
      if (std::abs(*system.margin()) < 1e-9) return;  // on the limit itself, to rounding
      EXPECT_EQ(*system.margin() > 0.0, system.is_stable()) << entry->info.name << " " << system.K << " " << system.B;
    });
  }
}

/// A step a little below a limit is stable, a little above it is not; without a limit every step is stable.
TEST(IntegratorTable, DampersAloneAreStableUpToTheirLimits) {
  constexpr double kMargin = 1e-6;
  for (const IntegratorEntry* entry : kIntegrators) {
    SCOPED_TRACE(entry->info.name);
    const double limit = std::min(entry->damper_limit, 1e9);
    const auto at = [&](double beta) { return SpringDamper{0.0, beta * 0.1 / 0.0005, 0.1, 0.0005, 1.0, entry}; };
    EXPECT_TRUE(at(limit * (1.0 - kMargin)).is_stable());
    EXPECT_EQ(at(limit * (1.0 + kMargin)).is_stable(), std::isinf(entry->damper_limit));
    if (std::isinf(entry->damper_limit))
      for_random_systems(entry, [](const SpringDamper& system) { EXPECT_TRUE(system.is_stable()); });
  }
}

/// kappa = lambda K dt^2 / M and beta = lambda B dt / M decide everything.
SpringDamper with(double kappa, double beta, double M = 0.1, double dt = 0.0005, double lambda = 1.0) {
  return {kappa * M / (lambda * dt * dt), beta * M / (lambda * dt), M, dt, lambda};
}

TEST(SpringDamper, HasTheTraceAndDeterminantOfEquationA2) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(10'000); ++i) {
    const double kappa = random.uniform(0.0, 5.0), beta = random.uniform(0.0, 3.0);
    const Eigen::Matrix2d A =
        with(kappa, beta, random.uniform(0.01, 1.0), random.uniform(1e-5, 1e-2), random.uniform(0.1, 10.0))
            .step_matrix();
    // Entries up to 5: some ten roundings of numbers up to 36.
    EXPECT_NEAR(A.trace(), 2.0 - kappa - beta, 1e-13);
    EXPECT_NEAR(A.determinant(), 1.0 - beta, 1e-13);
  }
}

TEST(SpringDamper, IsStableExactlyWhileTheInequalityOfA3Holds) {
  Random random(2);
  std::size_t stable = 0;
  const std::size_t n = test::cases(10'000);
  for (std::size_t i = 0; i < n; ++i) {
    const double kappa = random.uniform(0.0, 5.0), beta = random.uniform(0.0, 3.0);
    const double margin = 4.0 - 2.0 * beta - kappa;
    if (std::abs(margin) < 1e-9 || beta < 1e-9 || kappa < 1e-9) continue;  // on the limit itself, to rounding
    EXPECT_EQ(with(kappa, beta).is_stable(), margin > 0.0) << kappa << " " << beta;
    if (margin > 0.0) ++stable;
  }
  // The stable triangle is 4 of the 15 that are sampled.
  EXPECT_GT(stable, n / 5);
  EXPECT_LT(stable, n / 3);
}

TEST(SpringDamper, UnderVelocityVerletIsStableExactlyWhereItsHeaderSays) {
  Random random(3);
  for (std::size_t i = 0; i < test::cases(10'000); ++i) {
    const double kappa = random.uniform(0.0, 6.0), beta = random.uniform(0.0, 5.0), c = 1.0 - 0.5 * beta;
    SpringDamper system = with(kappa, beta);
    system.integrator = &kVelocityVerlet;
    const double margin = std::min(4.0 - beta, 4.0 * (1.0 + c * c) - kappa * (1.0 + c));
    if (std::abs(margin) < 1e-9 || beta < 1e-9 || kappa < 1e-9) continue;  // on the limit itself, to rounding
    EXPECT_EQ(system.is_stable(), margin > 0.0) << kappa << " " << beta;
  }
}

TEST(SpringDamper, HasTheDeterminantsOfItsIntegrators) {
  const double kappa = 0.6, beta = 0.3;
  const struct {
    const IntegratorEntry* integrator;
    double beta, determinant;
  } kClosedForms[] = {
      {&kLeapfrog, beta, 1.0 - beta},
      {&kVelocityVerlet, beta, std::pow(1.0 - beta / 2, 2)},
      {&kRk4, 0.0, std::pow(1 - kappa / 2 + kappa * kappa / 24, 2) + kappa * std::pow(1 - kappa / 6, 2)},
      {&kImplicitEuler, beta, 1.0 / (1.0 + beta + kappa)},
      {&kImplicitMidpoint, beta, (1.0 - beta / 2 + kappa / 4) / (1.0 + beta / 2 + kappa / 4)},
  };
  for (const auto& form : kClosedForms) {
    SpringDamper system = with(kappa, form.beta);
    system.integrator = form.integrator;
    EXPECT_NEAR(system.step_matrix().determinant(), form.determinant, 1e-14) << form.integrator->info.name;
  }
}

// Thesis A.3: stable while 4 - 2 B dt/M - K dt^2/M > 0. Runs a thousandth below and above each limit.

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

TEST(StabilityLimits, RunsAreStableUpToTheClosedForms) {
  const double K_max = 4 * kMass / (kStep * kStep), B_max = 2 * kMass / kStep, zeta = 0.7;
  const double K_damped = kMass * std::pow(2 * (std::sqrt(1 + zeta * zeta) - zeta) / kStep, 2);
  EXPECT_NEAR(K_max, 1.6e6, 1e-6);
  EXPECT_NEAR(B_max, 400.0, 1e-9);
  EXPECT_EQ(std::floor(K_damped), 433731) << "thesis";
  EXPECT_NEAR(damping_at_ratio(zeta, K_damped), 291.6, 0.05) << "thesis";
  const std::vector<Vec3> one = {Vec3::UnitX()}, five(5, Vec3::UnitY());
  for (const double side : {-1.0, 1.0}) {
    const double part = 1 + side * kMargin;
    const Outcome expected = side < 0 ? Outcome::completes : Outcome::diverges;
    EXPECT_EQ(run(one, part * K_max, 0.0), expected);
    EXPECT_EQ(run(five, part * K_max / 5, 0.0), expected) << "parallel springs share the limit";
    EXPECT_EQ(run(one, 0.0, part * B_max, Vec3::UnitX()), expected);
    EXPECT_EQ(run(one, part * K_damped, damping_at_ratio(zeta, part * K_damped)), expected);
  }
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
}  // namespace hapbench::stability_test
