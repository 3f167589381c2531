#include "sim/tool/motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/core/random.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::motion_test {
namespace {

constexpr double kRounding = 1e-15;

TEST(ToolPose, TurnsTheShortWayBeforeItRolls) {
  Random random(2);
  EXPECT_EQ(ToolPose{}.rotation(), Mat3(Mat3::Identity()));
  for (int i = 0; i < 1000; ++i) {
    const Vec3 axis = random.direction();
    const double roll = random.uniform(-3.0, 3.0);
    const Mat3 shortest = Eigen::Quaterniond::FromTwoVectors(-Vec3::UnitZ(), axis).toRotationMatrix();
    // Quaternions lose digits if the rotation is nearly half a turn, that is if axis.z() is nearly 1.
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

// Tolerance: one rounding each in a sine, a cosine, two products and a sum of numbers of at most 1.
constexpr double kScript = 4 * std::numeric_limits<double>::epsilon();

ScriptedMotion motion(Orientation orientation) {
  return ScriptedMotion(std::move(orientation), std::nullopt);
}

Mat3 rotation(const Motion& motion, double t) {
  return ToolPose{Vec3::Zero(), motion.axis_at(t), motion.roll_at(t)}.rotation();
}

Mat3 rotation(const Orientation& orientation) {
  return rotation(motion(orientation), 0.0);
}

TEST(ScriptedMotion, UpAndLeanTurnTheWholeFrame) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Mat3 R = test::random_rotation(random);
    const double tilt = random.uniform(-3.0, 3.0), azimuth = random.uniform(-3.0, 3.0),
                 roll = random.uniform(-3.0, 3.0);
    const Mat3 without = rotation({Vec3::UnitZ(), Vec3::UnitX(), tilt, azimuth, roll});
    EXPECT_LE((rotation({R.col(2), R.col(0), tilt, azimuth, roll}) - R * without).norm(), 8 * kScript);
  }
}

TEST(ScriptedMotion, ScriptsItsRollWhenThatMoves) {
  EXPECT_FALSE(motion({{0, 0, 1}, {1, 0, 0}, {}, Profile::Shape(Profile::Ramp{0.0, 1.0}), 0.3}).scripts_roll());
  EXPECT_TRUE(motion({{0, 0, 1}, {1, 0, 0}, {}, {}, Profile::Shape(Profile::Ramp{0.0, 1.0})}).scripts_roll());
}

using Sample = RecordedMotion::Sample;

TEST(RecordedMotion, IsLinearBetweenItsSamplesAndHeldConstantOutside) {
  const RecordedMotion motion(
      {{1.0, {0, 0, 8}, {0, 0, -1}}, {3.0, {4, -8, 8}, {1, 0, 0}}, {5.0, {7, 8, 9}, {0, 1, 0}}});
  const struct {
    double t;
    Vec3 position;
  } kPositions[] = {{-1e9, {0, 0, 8}}, {0.999, {0, 0, 8}}, {1.0, {0, 0, 8}}, {1.5, {1, -2, 8}},
                    {2.0, {2, -4, 8}}, {3.0, {4, -8, 8}},  {5.0, {7, 8, 9}}, {1e9, {7, 8, 9}}};
  for (const auto& [t, position] : kPositions) EXPECT_EQ(motion.position_at(t), position) << t;
  for (const double t : {-1e9, 0.999, 1.0}) EXPECT_EQ(motion.axis_at(t), Vec3(0, 0, -1));
  EXPECT_EQ(motion.axis_at(3.0), Vec3(1, 0, 0));
  for (const double t : {5.0, 5.001, 1e9}) EXPECT_EQ(motion.axis_at(t), Vec3(0, 1, 0));
  EXPECT_FALSE(motion.position_is_free());
}

TEST(RecordedMotion, OppositeAxesKeepTheLastDirectionHalfWay) {
  const RecordedMotion motion({{0.0, Vec3::Zero(), {0, 0, 1}}, {1.0, Vec3::Zero(), {0, 0, -1}}});
  EXPECT_EQ(motion.axis_at(0.25), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.5), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.75), Vec3(0, 0, -1));
}

TEST(RecordedMotion, RefusesNoSamplesTimesThatDoNotIncreaseAndOrientationsOfSomeOnly) {
  EXPECT_THROW(RecordedMotion({}), std::invalid_argument);
  const Vec3 p = Vec3::Zero(), axis = {0, 0, -1};
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{0.0, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{1.0, p, axis}, Sample{0.5, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{std::nan(""), p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis, Eigen::Quaterniond::Identity()}, Sample{1.0, p, axis}}),
               std::invalid_argument);
}

using Eigen::Quaterniond;

Sample oriented(double time, const Quaterniond& q) {
  return {time, Vec3::Zero(), {}, q};
}

Quaterniond random_orientation(Random& random) {
  return Quaterniond(test::random_rotation(random));
}

/// Tolerance: a few roundings of unit quaternions and of the conversions between quaternions and rotations.
constexpr double kQuaternion = 1e-14;

TEST(RecordedMotion, TurnsFromSampleToSampleAtConstantRateTheShortWay) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Quaterniond from = random_orientation(random), to = random_orientation(random);
    // The same rotation has two quaternions.
    const RecordedMotion motion({oriented(0.0, from), oriented(2.0, i % 2 == 0 ? to : Quaterniond(-to.coeffs()))});
    const Eigen::AngleAxisd whole(to * from.inverse());
    ASSERT_LE(whole.angle(), std::numbers::pi + kQuaternion);
    for (const double t : {0.0, 0.3, 1.0, 1.9, 2.0, 5.0}) {
      const double part = std::min(0.5 * t, 1.0);
      const Mat3 expected = Eigen::AngleAxisd(part * whole.angle(), whole.axis()) * from.toRotationMatrix();
      // Near half a turn, both arcs between the orientations are almost equally long. Rounding then decides which arc
      // is the shorter, so the tolerance grows.
      ASSERT_LE((rotation(motion, t) - expected).norm(), kQuaternion / (1.0 - whole.angle() / 3.1416)) << i << " " << t;
    }
  }
}

TEST(RecordedMotion, SamplesOfAnOrientationHaveItsAxis) {
  // The sample is not given as a list in braces, because g++ 14 then warns that the axis of its only element is
  // uninitialised.
  const RecordedMotion motion(std::vector(1, oriented(0.0, Quaterniond(0.5, 0.5, 0.5, 0.5))));
  EXPECT_LE((motion.samples()[0].axis - Vec3(-1, 0, 0)).norm(), kQuaternion);
  EXPECT_TRUE(motion.scripts_roll());
  EXPECT_FALSE(RecordedMotion({Sample{}}).scripts_roll());
  EXPECT_EQ(RecordedMotion({Sample{}}).roll_at(0.0), 0.0);
}

}  // namespace
}  // namespace hapbench::motion_test
