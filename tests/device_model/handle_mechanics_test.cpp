#include "device_model/handle_mechanics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/core/random.hpp"

namespace hapbench::handle_mechanics_test {
namespace {

constexpr double kStep = 1.0 / 2048;

TEST(HandleMechanics, StartsOnTheToolWithItsVelocity) {
  HandleMechanics mechanics({});
  ToolState tool;
  tool.pose.position = {1, 2, 3};
  tool.velocity = {4, 5, 6};
  mechanics.reset(tool);
  EXPECT_EQ(mechanics.handle().position, Vec3(1, 2, 3));
  EXPECT_EQ(mechanics.carriage().velocity, Vec3(4, 5, 6));
  EXPECT_EQ(mechanics.energy().stored, 0.0);
}

TEST(HandleMechanics, WithoutFrictionMomentumIsImpulse) {
  HandleMechanics mechanics({.carriage_mass = 0.25, .handle_mass = 0.07, .friction = 0.0});
  mechanics.reset({});
  const Vec3 hand{1, -2, 3}, actuator{0.5, 0.25, -4};
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) mechanics.advance(hand, actuator, kStep);
  const Vec3 momentum = 0.25 * mechanics.carriage().velocity + 0.07 * mechanics.handle().velocity;
  const Vec3 impulse = (hand + actuator) * (kSteps * kStep);
  // A few roundings a step.
  EXPECT_LE((momentum - impulse).norm(), 10 * kSteps * std::numeric_limits<double>::epsilon() * impulse.norm());
}

TEST(HandleMechanics, StandsStillUnderOppositeForcesWithTheStructureStretched) {
  const double k = 200000.0;
  HandleMechanics mechanics({.structure_stiffness = k});
  mechanics.reset({});
  for (int i = 0; i < 20000; ++i) mechanics.advance({3, 0, 0}, {-3, 0, 0}, kStep);
  // The transient has died out: its slowest rate is that of the structure's damping, some hundred per second.
  EXPECT_NEAR(mechanics.handle().position.x() - mechanics.carriage().position.x(), 3.0 / k, 1e-15);
  EXPECT_LE(mechanics.handle().velocity.norm(), 1e-12);
}

TEST(HandleMechanics, TheStructureSwingsAtItsFrequency) {
  HandleMechanicsConfig config;
  config.friction = config.structure_damping = 0.0;
  HandleMechanics mechanics(config);
  mechanics.reset({});
  // An impulse sets handle and carriage swinging against each other.
  constexpr double kFine = 1e-6;
  mechanics.advance({1000, 0, 0}, {0, 0, 0}, kFine);
  const auto stretch = [&] { return mechanics.handle().position.x() - mechanics.carriage().position.x(); };
  double last = stretch();
  std::vector<double> crossings;
  for (int i = 1; crossings.size() < 3; ++i) {
    mechanics.advance({0, 0, 0}, {0, 0, 0}, kFine);
    if (last < 0.0 && stretch() >= 0.0) crossings.push_back((i - stretch() / (stretch() - last)) * kFine);
    last = stretch();
  }
  const double reduced = 1.0 / (1.0 / config.carriage_mass + 1.0 / config.handle_mass);
  const double period = 2.0 * std::numbers::pi * std::sqrt(reduced / config.structure_stiffness);
  // The midpoint rule stretches a period by (omega dt)^2 / 12 = 3e-7 of it; the interpolation errs less.
  EXPECT_NEAR(crossings[2] - crossings[1], period, 1e-6 * period);
}

TEST(HandleMechanics, KeepsItsEnergyBalanceToRounding) {
  Random random(3);
  for (int run = 0; run < 50; ++run) {
    HandleMechanics mechanics({.carriage_mass = random.uniform(0.01, 2),
                               .handle_mass = random.uniform(0.01, 2),
                               .friction = random.uniform(0, 50),
                               .structure_stiffness = random.uniform(0, 1e7),
                               .structure_damping = random.uniform(0, 500)});
    ToolState tool;
    tool.velocity = random.direction();
    mechanics.reset(tool);
    double turnover = 0.0;
    for (int i = 0; i < 2000; ++i) {
      mechanics.advance(5.0 * random.direction(), 30.0 * random.direction(), kStep);
      const DeviceEnergy e = mechanics.energy();
      turnover = std::max({turnover, std::abs(e.hand), std::abs(e.actuator), -e.dissipated, std::abs(e.stored)});
      // Each step rounds sums of the size of the turnover, and of the elastic energy hidden in it: 1e-16 a step.
      ASSERT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-12 * (turnover + 1.0));
      ASSERT_LE(e.dissipated, 0.0);
    }
  }
}

}  // namespace
}  // namespace hapbench::handle_mechanics_test
