#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/experiments/stability_limits.hpp"
#include "sim/core/random.hpp"
#include "tests/support/scale.hpp"

namespace hapbench {
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

}  // namespace
}  // namespace hapbench
