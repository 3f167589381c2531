#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/core/random.hpp"
#include "sim/tool/motion.hpp"
#include "sim/tool/tool_state.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::recorded_motion_test {
namespace {

using Sample = RecordedMotion::Sample;

TEST(RecordedMotion, PassesThroughItsSamples) {
  const RecordedMotion motion({{0.0, {1, 2, 3}, {0, 0, -1}}, {0.5, {4, 5, 6}, {1, 0, 0}}, {2.0, {7, 8, 9}, {0, 1, 0}}});
  EXPECT_EQ(motion.position_at(0.0), Vec3(1, 2, 3));
  EXPECT_EQ(motion.position_at(0.5), Vec3(4, 5, 6));
  EXPECT_EQ(motion.position_at(2.0), Vec3(7, 8, 9));
  EXPECT_EQ(motion.axis_at(0.0), Vec3(0, 0, -1));
  EXPECT_EQ(motion.axis_at(0.5), Vec3(1, 0, 0));
  EXPECT_EQ(motion.axis_at(2.0), Vec3(0, 1, 0));
}

TEST(RecordedMotion, PositionIsLinearBetweenSamples) {
  const RecordedMotion motion({{1.0, {0, 0, 8}, {0, 0, -1}}, {3.0, {4, -8, 8}, {0, 0, -1}}});
  EXPECT_EQ(motion.position_at(1.5), Vec3(1, -2, 8));
  EXPECT_EQ(motion.position_at(2.0), Vec3(2, -4, 8));
}

TEST(RecordedMotion, IsHeldConstantOutside) {
  const RecordedMotion motion({{1.0, {1, 2, 3}, {0, 0, -1}}, {3.0, {4, 5, 6}, {1, 0, 0}}});
  for (const double t : {-1e9, 0.0, 0.999}) {
    EXPECT_EQ(motion.position_at(t), Vec3(1, 2, 3));
    EXPECT_EQ(motion.axis_at(t), Vec3(0, 0, -1));
  }
  for (const double t : {3.001, 1e9}) {
    EXPECT_EQ(motion.position_at(t), Vec3(4, 5, 6));
    EXPECT_EQ(motion.axis_at(t), Vec3(1, 0, 0));
  }
}

TEST(RecordedMotion, AxisIsNormalisedAfterInterpolation) {
  const RecordedMotion motion({{0.0, Vec3::Zero(), {1, 0, 0}}, {1.0, Vec3::Zero(), {0, 1, 0}}});
  const Vec3 half_way = motion.axis_at(0.5);
  // The mean (1/2, 1/2) is exact; its norm and the division round once each.
  EXPECT_NEAR(half_way.x(), std::sqrt(0.5), 2 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(half_way.x(), half_way.y());
  for (int k = 0; k <= 100; ++k) EXPECT_NEAR(motion.axis_at(k / 100.0).norm(), 1.0, 4e-16);
}

TEST(RecordedMotion, OppositeAxesKeepTheLastDirectionHalfWay) {
  const RecordedMotion motion({{0.0, Vec3::Zero(), {0, 0, 1}}, {1.0, Vec3::Zero(), {0, 0, -1}}});
  EXPECT_EQ(motion.axis_at(0.25), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.5), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.75), Vec3(0, 0, -1));
}

TEST(RecordedMotion, OneSampleIsAStillTool) {
  const RecordedMotion motion({{1.0, {1, 2, 3}, {1, 0, 0}}});
  for (const double t : {0.0, 1.0, 2.0}) {
    EXPECT_EQ(motion.position_at(t), Vec3(1, 2, 3));
    EXPECT_EQ(motion.axis_at(t), Vec3(1, 0, 0));
  }
}

TEST(RecordedMotion, PrescribesThePosition) {
  EXPECT_FALSE(RecordedMotion({Sample{}}).position_is_free());
}

TEST(RecordedMotion, RefusesNoSamplesAndTimesThatDoNotIncrease) {
  EXPECT_THROW(RecordedMotion({}), std::invalid_argument);
  const Vec3 p = Vec3::Zero(), axis = {0, 0, -1};
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{0.0, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{1.0, p, axis}, Sample{0.5, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{std::nan(""), p, axis}}), std::invalid_argument);
}

using Eigen::Quaterniond;

Sample oriented(double time, const Quaterniond& q) {
  return {time, Vec3::Zero(), {}, q};
}

Mat3 rotation(const RecordedMotion& motion, double t) {
  return ToolPose{Vec3::Zero(), motion.axis_at(t), motion.roll_at(t)}.rotation();
}

Quaterniond random_orientation(Random& random) {
  return Quaterniond(test::random_rotation(random));
}

/// A few roundings of unit quaternions and of the rotations they are turned into and out of.
constexpr double kRounding = 1e-14;

TEST(RecordedMotion, TurnsFromSampleToSampleAtConstantRateTheShortWay) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Quaterniond from = random_orientation(random), to = random_orientation(random);
    // The same rotation has two quaternions.
    const RecordedMotion motion({oriented(0.0, from), oriented(2.0, i % 2 == 0 ? to : Quaterniond(-to.coeffs()))});
    const Eigen::AngleAxisd whole(to * from.inverse());
    ASSERT_LE(whole.angle(), std::numbers::pi + kRounding);
    for (const double t : {0.0, 0.3, 1.0, 1.9, 2.0, 5.0}) {
      const double part = std::min(0.5 * t, 1.0);
      const Mat3 expected = Eigen::AngleAxisd(part * whole.angle(), whole.axis()) * from.toRotationMatrix();
      // Towards half a turn, the short way is that of the rounding of the sum of two nearly opposite quaternions.
      ASSERT_LE((rotation(motion, t) - expected).norm(), kRounding / (1.0 - whole.angle() / 3.1416)) << i << " " << t;
    }
  }
}

TEST(RecordedMotion, InterpolatesAsEigensSlerp) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Quaterniond from = random_orientation(random), to = random_orientation(random);
    const double part = random.uniform(0.0, 1.0);
    const RecordedMotion motion({oriented(0.0, from), oriented(1.0, to)});
    EXPECT_LE((rotation(motion, part) - from.slerp(part, to).toRotationMatrix()).norm(), kRounding);
  }
}

TEST(RecordedMotion, SamplesOfAnOrientationHaveItsAxis) {
  const RecordedMotion motion({oriented(0.0, Quaterniond(0.5, 0.5, 0.5, 0.5))});
  EXPECT_LE((motion.samples()[0].axis - Vec3(-1, 0, 0)).norm(), kRounding);
  EXPECT_TRUE(motion.scripts_roll());
  EXPECT_FALSE(RecordedMotion({Sample{}}).scripts_roll());
  EXPECT_EQ(RecordedMotion({Sample{}}).roll_at(0.0), 0.0);
}

TEST(RecordedMotion, RefusesOrientationsOfSomeSamplesOnly) {
  const Quaterniond q = Quaterniond::Identity();
  EXPECT_THROW(RecordedMotion({oriented(0.0, q), Sample{1.0, {}, {}}}), std::invalid_argument);
}

}  // namespace
}  // namespace hapbench::recorded_motion_test
