#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "sim/core/random.hpp"
#include "sim/loop/integrators/spring_damper.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::spring_damper_test {
namespace {

/// kappa = lambda K dt^2 / M and beta = lambda B dt / M decide everything.
SpringDamper with(double kappa, double beta, double M = 0.1, double dt = 0.0005, double lambda = 1.0) {
  return {kappa * M / (lambda * dt * dt), beta * M / (lambda * dt), M, dt, lambda};
}

TEST(SpringDamper, HasTheTraceAndDeterminantOfEquationA2) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(10'000); ++i) {
    const double kappa = random.uniform(0.0, 5.0), beta = random.uniform(0.0, 3.0);
    const SpringDamper system =
        with(kappa, beta, random.uniform(0.01, 1.0), random.uniform(1e-5, 1e-2), random.uniform(0.1, 10.0));
    const auto [first, second] = system.eigenvalues();
    // Entries up to 5 and eigenvalues up to 6: some ten roundings of numbers up to 36.
    EXPECT_NEAR((first + second).real(), 2.0 - kappa - beta, 1e-13);
    EXPECT_NEAR((first * second).real(), 1.0 - beta, 1e-13);
    EXPECT_NEAR((first + second).imag(), 0.0, 1e-13);
    EXPECT_EQ(system.spectral_radius(), std::max(std::abs(first), std::abs(second)));
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
    EXPECT_EQ(with(kappa, beta).spectral_radius() < 1.0, margin > 0.0) << kappa << " " << beta;
    if (margin > 0.0) ++stable;
  }
  // The stable triangle is 4 of the 15 that are sampled.
  EXPECT_GT(stable, n / 5);
  EXPECT_LT(stable, n / 3);
}

TEST(SpringDamper, WithoutDampingStaysOnTheUnitCircleUntilItsLimit) {
  for (const double kappa : {1e-3, 0.1, 1.0, 3.9}) EXPECT_NEAR(with(kappa, 0.0).spectral_radius(), 1.0, 1e-13) << kappa;
  EXPECT_GT(with(4.01, 0.0).spectral_radius(), 1.05);
}

TEST(SpringDamper, WithoutASpringNeverForgetsItsPosition) {
  for (const double beta : {0.0, 0.5, 1.0, 1.999}) EXPECT_NEAR(with(0.0, beta).spectral_radius(), 1.0, 1e-13) << beta;
  EXPECT_NEAR(with(0.0, 3.0).spectral_radius(), 2.0, 1e-13);
}

TEST(SpringDamper, IsOnlyScaledByLambda) {
  const SpringDamper one{20000.0, 60.0, 0.1, 0.0005, 7.0}, seven{140000.0, 420.0, 0.1, 0.0005, 1.0};
  EXPECT_NEAR(one.spectral_radius(), seven.spectral_radius(), 1e-14);
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

TEST(SpringDamper, UnderImplicitIntegratorsIsStableHoweverStiff) {
  Random random(4);
  for (const IntegratorEntry* integrator : {&kImplicitEuler, &kImplicitMidpoint}) {
    for (std::size_t i = 0; i < test::cases(10'000); ++i) {
      SpringDamper system =
          with(std::pow(10.0, random.uniform(-6.0, 12.0)), std::pow(10.0, random.uniform(-6.0, 12.0)));
      if (i % 4 == 0) system.B = 0.0;
      system.integrator = integrator;
      EXPECT_TRUE(system.is_stable()) << system.K << " " << system.B;
    }
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

}  // namespace
}  // namespace hapbench::spring_damper_test
