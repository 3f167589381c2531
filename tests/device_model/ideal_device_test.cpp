#include "device_model/ideal_device.hpp"

#include <gtest/gtest.h>

namespace hapbench::ideal_device_test {
namespace {

ToolState some_tool() {
  ToolState tool;
  tool.pose.position = {1, 2, 3};
  tool.velocity = {4, 5, 6};
  return tool;
}

TEST(IdealDevice, HandleIsTheToolAfterResetAndAfterEveryStep) {
  IdealDevice device(std::nullopt);
  device.reset(some_tool());
  EXPECT_EQ(device.handle().position, Vec3(1, 2, 3));
  EXPECT_EQ(device.handle().velocity, Vec3(4, 5, 6));
  ToolState moved = some_tool();
  moved.pose.position.x() = 7;
  moved.velocity.z() = 8;
  device.advance(moved, {100, 100, 100}, 0.5);
  EXPECT_EQ(device.handle().position, Vec3(7, 2, 3));
  EXPECT_EQ(device.handle().velocity, Vec3(4, 5, 8));
}

TEST(IdealDevice, MeasuresTheHandExactlyAndPassesItOnWithoutALimit) {
  IdealDevice device(std::nullopt);
  const MeasuredForce force = device.measure({300, -400, 0});
  EXPECT_EQ(force.measured, Vec3(300, -400, 0));
  EXPECT_EQ(force.input, Vec3(300, -400, 0));
}

TEST(IdealDevice, LimitsTheInputButNotTheMeasurement) {
  IdealDevice device(2.0);
  const MeasuredForce force = device.measure({300, -400, 0});
  EXPECT_EQ(force.measured, Vec3(300, -400, 0));
  EXPECT_LE((force.input - Vec3(1.2, -1.6, 0)).norm(), 4 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(device.measure({1, 1, 1}).input, Vec3(1, 1, 1));
}

TEST(IdealDevice, MeasuringDoesNotMoveTheHandle) {
  IdealDevice device(2.0);
  device.reset(some_tool());
  device.measure({300, -400, 0});
  EXPECT_EQ(device.handle().position, Vec3(1, 2, 3));
}

}  // namespace
}  // namespace hapbench::ideal_device_test
