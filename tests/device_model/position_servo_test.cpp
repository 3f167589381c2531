#include "device_model/position_servo.hpp"

#include <gtest/gtest.h>

namespace hapbench::position_servo_test {
namespace {

ToolState reference(const Vec3& position, const Vec3& velocity) {
  ToolState tool;
  tool.pose.position = position;
  tool.velocity = velocity;
  return tool;
}

TEST(PositionServo, PushesAgainstPositionAndVelocityErrors) {
  PositionServo servo({.stiffness = 100, .damping = 10, .max_force = 1e9, .delay = 0});
  EXPECT_EQ(servo.force(reference({1, 2, 3}, {4, 5, 6}), {0, 2, 4}, {4, 4, 8}), Vec3(100, 10, -120));
}

TEST(PositionServo, SaturatesAtTheNormOfItsForce) {
  PositionServo servo({.stiffness = 1, .damping = 0, .max_force = 30, .delay = 0});
  EXPECT_EQ(servo.force(reference({18, 24, 0}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0}), Vec3(18, 24, 0)) << "30 N";
  const Vec3 saturated = servo.force(reference({300, 0, -400}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0});
  EXPECT_LE((saturated - Vec3(18, 0, -24)).norm(), 1e-14);
}

TEST(PositionServo, ACommandArrivesAfterTheDelay) {
  for (const std::size_t delay : {0u, 1u, 2u, 7u}) {
    PositionServo servo({.stiffness = 1, .damping = 0, .max_force = 1e9, .delay = delay});
    for (int round = 0; round < 2; ++round) {
      for (int k = 0; k < 20; ++k) {
        const Vec3 force = servo.force(reference({k + 1.0, 0, 0}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0});
        EXPECT_EQ(force.x(), std::max(0.0, k + 1.0 - static_cast<double>(delay))) << delay << " " << k;
      }
      servo.reset();  // the second round starts at rest again
    }
  }
}

}  // namespace
}  // namespace hapbench::position_servo_test
