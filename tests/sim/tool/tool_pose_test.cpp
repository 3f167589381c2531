#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "sim/core/random.hpp"
#include "sim/tool/tool_state.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::tool_pose_test {
namespace {

constexpr double kRounding = 1e-15;

TEST(ToolPose, IsARotationThatTakesMinusZToTheAxis) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const ToolPose pose{Vec3::Zero(), random.direction(), random.uniform(-4.0, 4.0)};
    const Mat3 R = pose.rotation();
    EXPECT_LE((R.transpose() * R - Mat3::Identity()).norm(), 8 * kRounding);
    EXPECT_NEAR(R.determinant(), 1.0, 8 * kRounding);
    EXPECT_LE((R * -Vec3::UnitZ() - pose.axis).norm(), 8 * kRounding);
  }
}

TEST(ToolPose, TurnsTheShortWayBeforeItRolls) {
  Random random(2);
  EXPECT_EQ(ToolPose{}.rotation(), Mat3(Mat3::Identity()));
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random.direction();
    const double roll = random.uniform(-3.0, 3.0);
    const Mat3 shortest = Eigen::Quaterniond::FromTwoVectors(-Vec3::UnitZ(), axis).toRotationMatrix();
    // Quaternions lose digits where the turn is nearly half a turn.
    const double tolerance = 1e-14 / (1.0 - axis.z());
    EXPECT_LE((ToolPose{Vec3::Zero(), axis}.rotation() - shortest).norm(), tolerance);
    const Mat3 rolled = Eigen::AngleAxisd(roll, axis) * shortest;
    EXPECT_LE((ToolPose{Vec3::Zero(), axis, roll}.rotation() - rolled).norm(), tolerance);
  }
}

TEST(ToolPose, StaysARotationWhereTheAxisIsAlmostPlusZ) {
  EXPECT_EQ((ToolPose{Vec3::Zero(), {0, 0, 1}}.rotation()), Mat3(Vec3(1, -1, -1).asDiagonal()));
  for (const double tilt : {1e-200, 1e-17, 1e-12, 1e-8, 1e-4}) {
    const Vec3 axis = Vec3(tilt, 0.5 * tilt, 1.0).normalized();
    const Mat3 R = ToolPose{Vec3::Zero(), axis}.rotation();
    EXPECT_LE((R.transpose() * R - Mat3::Identity()).norm(), 8 * kRounding) << tilt;
    EXPECT_LE((R * -Vec3::UnitZ() - axis).norm(), 8 * kRounding) << tilt;
  }
}

TEST(ToolPose, AxisAndRollAreAnyRotation) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 R = test::random_rotation(random);
    const Vec3 axis = -R.col(2);
    const ToolPose pose{Vec3::Zero(), axis, roll_towards(axis, R.col(0))};
    EXPECT_LE((pose.rotation() - R).norm(), 16 * kRounding);
  }
}

TEST(ToolPose, TurnsByTheRotationVectorFromOneToTheOther) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const ToolPose from{Vec3::Zero(), random.direction(), random.uniform(-3.0, 3.0)};
    const Vec3 vector = random.uniform(0.0, 0.9 * std::numbers::pi) * random.direction();
    const Mat3 R = Eigen::AngleAxisd(vector.norm(), vector.normalized()) * from.rotation();
    const Vec3 axis = -R.col(2);
    const ToolPose to{Vec3::Zero(), axis, roll_towards(axis, R.col(0))};
    EXPECT_LE((turn(from, to) - vector).norm(), 100 * kRounding);
  }
}

TEST(ToolPose, WithoutRollTurnsAsItsAxisDoes) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const ToolPose from{Vec3::Zero(), random.direction()}, to{Vec3::Zero(), random.direction()};
    EXPECT_EQ(turn(from, to), turn(from.axis, to.axis));
  }
}

}  // namespace
}  // namespace hapbench::tool_pose_test
