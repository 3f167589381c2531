#include "device_model/admittance_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/core/random.hpp"

/// The admittance device and its parts; AdmittanceLoop compares it with a linear map.
namespace hapbench::admittance_device_test {
namespace {

constexpr double kStep = 1.0 / 2048;

TEST(InputForceLimiter, ScalesLongerForcesToTheLimitAndLeavesOthersUntouched) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 u = random.direction(), shorter = random.uniform() * random.direction();
    const double limit = random.uniform(0.1, 10.0);
    const Vec3 limited = limit_input_force(limit * random.uniform(1.0, 100.0) * u, limit);
    EXPECT_LE((limited - limit * u).norm(), 4 * std::numeric_limits<double>::epsilon() * limit);
    EXPECT_EQ(limit_input_force(shorter, 1.0), shorter);
  }
  EXPECT_EQ(limit_input_force({3, 4, 0}, 5.0), Vec3(3, 4, 0)) << "the limit itself";
  EXPECT_EQ(limit_input_force({3, 4, 0}, 0.0), Vec3(0, 0, 0));
  EXPECT_EQ(limit_input_force({0, 0, 0}, 0.0), Vec3(0, 0, 0));
}

TEST(ForceSensor, NoiseHasTheGivenDeviationInEveryComponentAndNoMean) {
  const double sigma = 0.02;
  ForceSensor sensor({.weight = 0.0, .noise = sigma, .seed = 5});
  constexpr int kSamples = 100'000;
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero(), products = Vec3::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 e = sensor.read({0, 0, 0}) / sigma;
    sum += e;
    squares += e.cwiseAbs2();
    products += Vec3(e.x() * e.y(), e.y() * e.z(), e.z() * e.x());
  }
  // Five standard errors: 1 / sqrt(n) of the mean and of a product, sqrt(2 / n) of the square.
  const double error = 5.0 / std::sqrt(kSamples);
  EXPECT_LE((sum / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((products / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((squares / kSamples - Vec3::Ones()).cwiseAbs().maxCoeff(), std::sqrt(2.0) * error);
}

TEST(ForceSensor, TheSeedDecidesTheNoiseAndAResetRepeatsIt) {
  const auto first_reading = [](std::uint64_t seed) {
    return ForceSensor({.noise = 1.0, .seed = seed}).read({0, 0, 0});
  };
  EXPECT_NE(first_reading(1), first_reading(2));
  ForceSensor sensor({.noise = 1.0, .seed = 1});
  const Vec3 first = sensor.read({0, 0, 0});
  EXPECT_NE(sensor.read({0, 0, 0}), first);
  sensor.reset();
  EXPECT_EQ(sensor.read({0, 0, 0}), first);
}

ToolState reference(const Vec3& position, const Vec3& velocity) {
  ToolState tool;
  tool.pose.position = position;
  tool.velocity = velocity;
  return tool;
}

TEST(PositionServo, SaturatesAtTheNormOfItsForce) {
  PositionServo servo({.stiffness = 1, .damping = 0, .max_force = 30, .delay = 0});
  EXPECT_EQ(servo.force(reference({18, 24, 0}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0}), Vec3(18, 24, 0)) << "30 N";
  const Vec3 saturated = servo.force(reference({300, 0, -400}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0});
  EXPECT_LE((saturated - Vec3(18, 0, -24)).norm(), 1e-14);
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

TEST(AdmittanceDevice, TheLimitTakesHoldWhereTheThesisSeesIt) {
  AdmittanceDevice device({});
  for (const double push : {0.5, 1.5, 1.999, 2.0, 2.5, 10.0}) {
    const MeasuredForce force = device.measure({0, 0, -push});
    EXPECT_NEAR(force.measured.z(), -push - 0.7, 1e-15) << "the log holds the weight: 2.7 N at the limit (Fig. 6)";
    EXPECT_NEAR(force.input.z(), -std::min(push, 2.0), 1e-15);
  }
}

TEST(AdmittanceDevice, WithoutCompensationTheWeightPullsAndTheLimitCountsIt) {
  AdmittanceDeviceConfig config;
  config.sensor.compensated = false;
  AdmittanceDevice device(config);
  EXPECT_NEAR(device.measure({0, 0, 0}).input.z(), -0.7, 1e-15);
  EXPECT_NEAR(device.measure({0, 0, -1.5}).input.z(), -2.0, 1e-15);
}

TEST(AdmittanceDevice, AHandThatPushesFindsServoAndStructureInSeries) {
  const AdmittanceDeviceConfig config;
  AdmittanceDevice device(config);
  device.reset({});
  for (int i = 0; i < 8192; ++i) device.advance({}, {0, 0, -4}, kStep);
  const double compliance = 1.0 / config.servo.stiffness + 1.0 / config.mechanics.structure_stiffness;
  EXPECT_NEAR(device.handle().position.z(), -4.0 * compliance, 1e-9 * compliance);
}

TEST(AdmittanceDevice, AHandStrongerThanTheActuatorsMovesTheHandle) {
  for (const double push : {29.0, 31.0}) {
    AdmittanceDevice device({});
    device.reset({});
    for (int i = 0; i < 8192; ++i) device.advance({}, {0, 0, -push}, kStep);
    // Four seconds of 1 N beyond the 30 N against 2 N s/m of friction: metres.
    EXPECT_EQ(device.handle().position.z() < -0.5, push > 30.0);
  }
}

TEST(AdmittanceDevice, AResetRepeatsEverythingBitForBit) {
  AdmittanceDeviceConfig config;
  config.sensor.noise = 0.1;
  AdmittanceDevice device(config);
  std::vector<Vec3> seen[2];
  for (auto& values : seen) {
    device.reset({});
    ToolState tool;
    tool.pose.position.x() = 0.01;
    for (int i = 0; i < 100; ++i) {
      values.push_back(device.measure({1, 2, 3}).input);
      device.advance(tool, {1, 2, 3}, kStep);
      values.push_back(device.handle().position);
    }
  }
  EXPECT_EQ(seen[0], seen[1]);
}

}  // namespace
}  // namespace hapbench::admittance_device_test
