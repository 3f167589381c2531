#include "scenarios/thesis/measurements.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hapbench::measurements_test {
namespace {

/// x = exp(-zeta t) cos(sqrt(1 - zeta^2) t), a hundred samples a unit of time.
std::optional<double> measured(double zeta) {
  std::vector<double> x;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.01 * i;
    x.push_back(std::exp(-zeta * t) * std::cos(std::sqrt(1.0 - zeta * zeta) * t));
  }
  return damping_ratio_of_swings(x);
}

TEST(DampingRatioOfSwings, IsThatOfADampedOscillation) {
  // Sampling misses an extreme by at most half a step: a relative error of its height of (0.005)^2 / 2 ~ 1e-5, which
  // is small beside ln q = pi zeta / sqrt(1 - zeta^2) >= 0.15.
  for (const double zeta : {0.05, 0.1, 0.3, 0.5}) EXPECT_NEAR(measured(zeta).value(), zeta, 1e-3 * zeta) << zeta;
}

TEST(DampingRatioOfSwings, IsZeroForSwingsThatGrow) {
  EXPECT_EQ(measured(-0.01), 0.0);
}

TEST(DampingRatioOfSwings, IsNoneWithoutSwings) {
  EXPECT_FALSE(damping_ratio_of_swings(std::vector<double>(3000, 1.0)));
  EXPECT_FALSE(measured(1.0)) << "it creeps";
}

}  // namespace
}  // namespace hapbench::measurements_test
