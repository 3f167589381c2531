#include "scenarios/thesis_claims/measurements.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hapbench::measurements_test {
namespace {

/// x = exp(-zeta t) cos(sqrt(1 - zeta^2) t), a hundred samples a unit of time.
double measured(double zeta) {
  SwingDecay swings;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.01 * i;
    swings.add(std::exp(-zeta * t) * std::cos(std::sqrt(1.0 - zeta * zeta) * t));
  }
  return swings.damping_ratio().value();
}

TEST(SwingDecay, GivesTheDampingRatioOfADampedOscillation) {
  // Sampling misses an extreme by at most half a step: a relative error of its height of (0.005)^2 / 2 ~ 1e-5, which
  // is small beside ln q = pi zeta / sqrt(1 - zeta^2) >= 0.15.
  for (const double zeta : {0.05, 0.1, 0.3, 0.5}) EXPECT_NEAR(measured(zeta), zeta, 1e-3 * zeta) << zeta;
}

TEST(SwingDecay, IsZeroForSwingsThatGrow) {
  SwingDecay growing;
  for (int i = 0; i < 100; ++i) growing.add(std::exp(0.01 * i) * std::cos(i));
  EXPECT_EQ(growing.damping_ratio(), 0.0);
}

TEST(SwingDecay, IsNoneWithoutSwings) {
  SwingDecay still, creeping;
  for (int i = 0; i < 3000; ++i) {
    still.add(1.0);
    creeping.add(std::exp(-0.01 * i));
  }
  EXPECT_FALSE(still.damping_ratio());
  EXPECT_FALSE(creeping.damping_ratio());
}

}  // namespace
}  // namespace hapbench::measurements_test
