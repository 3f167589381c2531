#include "device_model/force_path.hpp"

#include <gtest/gtest.h>

namespace hapbench::force_path_test {
namespace {

TEST(ForcePath, ChangesNothingByDefault) {
  ForcePath path({}, 0.001);
  const Vec3 force(1.0 / 3.0, -200.0, 1e-9);
  EXPECT_EQ(path.hold(force).after, force);
  EXPECT_EQ(path.switch_part(), 0.0);
}

TEST(ForcePath, RoundsToTheStepHalvesAwayFromZero) {
  ForcePath path({.step = 0.25, .max = {}, .slew = {}, .delay_samples = 0.0}, 0.001);
  EXPECT_EQ(path.hold({0.125, -0.125, 0.124}).after, Vec3(0.25, -0.25, 0.0));
  EXPECT_EQ(path.hold({1.0, 0.9, -7.3}).after, Vec3(1.0, 1.0, -7.25));
}

TEST(ForcePath, SaturatesTheNormAfterRounding) {
  ForcePath path({.step = 1.0, .max = 5.0, .slew = {}, .delay_samples = 0.0}, 0.001);
  EXPECT_EQ(path.hold({3.2, 4.1, 0.0}).after, Vec3(3, 4, 0)) << "at the limit";
  EXPECT_EQ(path.hold({6.0, 8.0, 0.4}).after, Vec3(3, 4, 0));
}

TEST(ForcePath, LimitsTheChangeOfTheForce) {
  ForcePath path({.step = 0.0, .max = {}, .slew = 1000.0, .delay_samples = 0.0}, 0.001);  // 1 N a period
  EXPECT_EQ(path.hold({3.0, 0.0, 0.0}).after, Vec3(1, 0, 0)) << "from zero";
  EXPECT_EQ(path.hold({3.0, 0.0, 0.0}).after, Vec3(2, 0, 0));
  EXPECT_EQ(path.hold({2.5, 0.0, 0.0}).after, Vec3(2.5, 0, 0));
  EXPECT_EQ(path.hold({-9.0, 0.0, 0.0}).after, Vec3(1.5, 0, 0));
  path.reset();
  EXPECT_EQ(path.hold({0.0, -3.0, 0.0}).after, Vec3(0, -1, 0));
}

TEST(ForcePath, DelaysByWholeAndFractionalPeriods) {
  for (const double delay : {0.0, 0.25, 1.0, 2.5, 3.0}) {
    ForcePath path({.step = 0.0, .max = {}, .slew = {}, .delay_samples = delay}, 0.001);
    EXPECT_EQ(path.switch_part(), delay - std::floor(delay));
    for (int round = 0; round < 2; ++round) {
      for (int k = 0; k < 10; ++k) {
        // Force k + 1 acts from k + delay on; what acts before the first is zero.
        const HeldForce held = path.hold({k + 1.0, 0, 0});
        EXPECT_EQ(held.after.x(), std::max(0.0, k + 1.0 - std::floor(delay))) << delay;
        EXPECT_EQ(held.before.x(), std::max(0.0, k - std::floor(delay))) << delay;
      }
      path.reset();
    }
  }
}

}  // namespace
}  // namespace hapbench::force_path_test
