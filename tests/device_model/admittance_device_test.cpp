#include "device_model/admittance_device.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hapbench::admittance_device_test {
namespace {

constexpr double kStep = 1.0 / 2048;

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

TEST(AdmittanceDevice, NoLimitPassesEverythingOn) {
  AdmittanceDeviceConfig config;
  config.force_limit.reset();
  EXPECT_NEAR(AdmittanceDevice(config).measure({0, 0, -50}).input.z(), -50.0, 1e-14);
}

TEST(AdmittanceDevice, TheHandleSettlesOnTheTool) {
  AdmittanceDevice device({});
  device.reset({});
  ToolState tool;
  tool.pose.position = {0.001, -0.002, 0.0005};
  for (int i = 0; i < 4096; ++i) device.advance(tool, {0, 0, 0}, kStep);
  EXPECT_LE((device.handle().position - tool.pose.position).norm(), 1e-12);
  EXPECT_LE(device.handle().velocity.norm(), 1e-9);
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

TEST(AdmittanceDevice, FollowsASlowMotionClosely) {
  AdmittanceDevice device({});
  device.reset({});
  double worst = 0.0;
  constexpr double kAmplitude = 0.001, kOmega = 2.0 * std::numbers::pi;  // 1 Hz
  for (int i = 1; i <= 8192; ++i) {
    ToolState tool;
    tool.pose.position.x() = kAmplitude * std::sin(kOmega * i * kStep);
    tool.velocity.x() = kAmplitude * kOmega * std::cos(kOmega * i * kStep);
    device.advance(tool, {0, 0, 0}, kStep);
    if (i > 2048) worst = std::max(worst, std::abs(device.handle().position.x() - tool.pose.position.x()));
  }
  // The servo lags by its delay and the friction needs b v / k; together under 2 % of the amplitude.
  EXPECT_LE(worst, 0.02 * kAmplitude);
  EXPECT_GT(worst, 0.0);
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
