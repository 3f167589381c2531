#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/tool/motion.hpp"
#include "sim/tool/tool_state.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::scripted_motion_test {
namespace {

using std::numbers::pi;

// One rounding each in a sine, a cosine, two products and a sum of numbers of at most 1.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

ScriptedMotion motion(Orientation orientation) {
  return ScriptedMotion(std::move(orientation), std::nullopt);
}

void expect_near(const Vec3& a, const Vec3& b) {
  EXPECT_LE((a - b).norm(), kRounding) << a.transpose() << " instead of " << b.transpose();
}

TEST(ScriptedMotion, WithoutTiltTheTipPointsDown) {
  expect_near(motion({{0, 0, 1}, {1, 0, 0}, {}, {}}).axis_at(0.0), {0, 0, -1});
  expect_near(motion({{0, 1, 0}, {1, 0, 0}, {}, {}}).axis_at(0.0), {0, -1, 0});
}

TEST(ScriptedMotion, TiltLeansTheHandleTowardsLean) {
  // The tip points away from where the handle leans: axis = -(cos up + sin lean).
  const double tilt = 0.3;
  expect_near(motion({{0, 0, 1}, {1, 0, 0}, tilt, {}}).axis_at(0.0), {-std::sin(tilt), 0, -std::cos(tilt)});
  expect_near(motion({{0, 1, 0}, {1, 0, 0}, tilt, {}}).axis_at(0.0), {-std::sin(tilt), -std::cos(tilt), 0});
}

TEST(ScriptedMotion, AQuarterTurnOfTiltLaysTheToolDown) {
  expect_near(motion({{0, 0, 1}, {1, 0, 0}, pi / 2, {}}).axis_at(0.0), {-1, 0, 0});
}

TEST(ScriptedMotion, AzimuthTurnsLeanRightHandedAboutUp) {
  // About +z, a quarter turn takes +x to +y, another one to -x.
  expect_near(motion({{0, 0, 1}, {1, 0, 0}, pi / 2, pi / 2}).axis_at(0.0), {0, -1, 0});
  expect_near(motion({{0, 0, 1}, {1, 0, 0}, pi / 2, pi}).axis_at(0.0), {1, 0, 0});
  // About +y, +x goes to -z.
  expect_near(motion({{0, 1, 0}, {1, 0, 0}, pi / 2, pi / 2}).axis_at(0.0), {0, 0, 1});
}

TEST(ScriptedMotion, AzimuthIsARotationOfTheWholeOrientation) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Mat3 frame = test::random_rotation(random);
    const Vec3 up = frame.col(0), lean = frame.col(1);
    const double tilt = random.uniform(-pi, pi), azimuth = random.uniform(-10.0, 10.0);
    const Vec3 without = motion({up, lean, tilt, {}}).axis_at(0.0);
    const Vec3 with = motion({up, lean, tilt, azimuth}).axis_at(0.0);
    // The random frame is itself orthonormal only to rounding.
    EXPECT_LE((with - Eigen::AngleAxisd(azimuth, up) * without).norm(), 4 * kRounding);
  }
}

TEST(ScriptedMotion, AxisIsAUnitVectorAtAllTimes) {
  const ScriptedMotion m =
      motion({{0, 0, 1}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), Profile::Shape(Profile::Ramp{-2.0, 7.0})});
  for (int k = 0; k < 1000; ++k) EXPECT_NEAR(m.axis_at(0.01 * k).norm(), 1.0, kRounding);
}

TEST(ScriptedMotion, FollowsItsProfilesInTime) {
  // The 2-D peg of thesis A.1: 0.1 rad at the start, 1.2 rad/s.
  const ScriptedMotion m = motion({{0, 1, 0}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), {}});
  const double tilt = 0.1 + 1.2 * 0.5;
  expect_near(m.axis_at(0.5), {-std::sin(tilt), -std::cos(tilt), 0});
}

TEST(ScriptedMotion, PlanarScenesStayInTheirPlane) {
  const ScriptedMotion m = motion({{0, 1, 0}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), {}});
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(m.axis_at(0.001 * k).z(), 0.0);
}

TEST(ScriptedMotion, PositionIsFreeUnlessPrescribed) {
  EXPECT_TRUE(motion({}).position_is_free());
  const ScriptedMotion prescribed({}, std::array<Profile, 3>{1.0, Profile::Shape(Profile::Ramp{0.0, 2.0}), -1.0});
  EXPECT_FALSE(prescribed.position_is_free());
  EXPECT_EQ(prescribed.position_at(3.0), Vec3(1.0, 6.0, -1.0));
}

Mat3 rotation(const Orientation& orientation, double t = 0.0) {
  const ScriptedMotion m = motion(orientation);
  return ToolPose{Vec3::Zero(), m.axis_at(t), m.roll_at(t)}.rotation();
}

TEST(ScriptedMotion, AtAnglesOfZeroTheToolsFrameIsLeanSidewaysAndUp) {
  EXPECT_LE((rotation({{0, 0, 1}, {1, 0, 0}, {}, {}}) - Mat3::Identity()).norm(), kRounding);
  Mat3 planar;
  planar << Vec3::UnitX(), -Vec3::UnitZ(), Vec3::UnitY();
  EXPECT_LE((rotation({{0, 1, 0}, {1, 0, 0}, {}, {}}) - planar).norm(), kRounding);
}

TEST(ScriptedMotion, AnglesAreThoseOfEuler) {
  const double tilt = 0.7, azimuth = -1.3, roll = 2.1;
  const Mat3 expected = (Eigen::AngleAxisd(azimuth, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitY()) *
                         Eigen::AngleAxisd(roll, -Vec3::UnitZ()))
                            .toRotationMatrix();
  EXPECT_LE((rotation({{0, 0, 1}, {1, 0, 0}, tilt, azimuth, roll}) - expected).norm(), 4 * kRounding);
}

TEST(ScriptedMotion, UpAndLeanTurnTheWholeFrame) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Mat3 R = test::random_rotation(random);
    const double tilt = random.uniform(-3.0, 3.0), azimuth = random.uniform(-3.0, 3.0),
                 roll = random.uniform(-3.0, 3.0);
    const Mat3 without = rotation({Vec3::UnitZ(), Vec3::UnitX(), tilt, azimuth, roll});
    EXPECT_LE((rotation({R.col(2), R.col(0), tilt, azimuth, roll}) - R * without).norm(), 8 * kRounding);
  }
}

TEST(ScriptedMotion, ScriptsItsRollWhenThatMoves) {
  EXPECT_FALSE(motion({{0, 0, 1}, {1, 0, 0}, {}, Profile::Shape(Profile::Ramp{0.0, 1.0}), 0.3}).scripts_roll());
  EXPECT_TRUE(motion({{0, 0, 1}, {1, 0, 0}, {}, {}, Profile::Shape(Profile::Ramp{0.0, 1.0})}).scripts_roll());
}

}  // namespace
}  // namespace hapbench::scripted_motion_test
