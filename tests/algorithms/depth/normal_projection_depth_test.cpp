#include "algorithms/depth/normal_projection_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/contact/contact_query.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::normal_projection_depth_test {
namespace {

using test::Vec3L;

double depth_at(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal) {
  ContactBuffer contacts(1);
  contacts.push(0, point, normal);
  make_normal_projection_depth()->evaluate(tool, pose, contacts);
  EXPECT_EQ(contacts.gradient(0), Vec3(-normal));
  return contacts.depth[0];
}

/// Whether the search reports the point, as it does for every point a depth model sees.
bool collides(const Cylinder& tool, const ToolPose& pose, const Vec3& point) {
  const PointShell shell({{point, Vec3::UnitZ()}}, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  return !contacts.empty();
}

class NormalProjectionDepthForTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, NormalProjectionDepthForTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

/// Checks that the ray from the point against its normal leaves the tool after `depth`: there the slack is zero, and
/// not yet before nor any more after. Slacks carry a few roundings of coordinates up to 1 m.
void expect_exit(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal, double depth) {
  constexpr long double rounding = 2e-15L;
  const Vec3L x = point.cast<long double>(), u = -normal.cast<long double>();
  const auto slack_at = [&](long double d) { return test::slack(tool, pose, x + d * u); };
  ASSERT_GE(depth, 0.0);
  ASSERT_LE(std::abs(slack_at(depth)), rounding);
  // The slack is concave along the ray: inside half-way, and if the ray went on inside it would show a little later.
  ASSERT_GE(slack_at(0.5L * depth), -rounding);
  ASSERT_LE(slack_at(depth + 0.001L * tool.radius()), rounding);
}

TEST_P(NormalProjectionDepthForTip, IsWhereTheRayAgainstTheNormalLeavesTheTool) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_near(tool, pose, random);
    if (test::slack(tool, pose, point.cast<long double>()) < 0.0L) continue;
    const Vec3 normal = random.direction();
    const double depth = depth_at(tool, pose, point, normal);
    expect_exit(tool, pose, point, normal, depth);
    // Marching along the ray by bisection, to the rounding of the slack over the rate at which it falls at the exit.
    const long double marched = test::exit_along(tool, pose, point.cast<long double>(), -normal.cast<long double>());
    const long double h = 1e-9L * tool.radius();
    const long double rate =
        -test::slack(tool, pose, point.cast<long double>() - (marched + h) * normal.cast<long double>()) / h;
    ASSERT_NEAR(static_cast<double>(marched - depth), 0.0, static_cast<double>(2e-15L / rate));
  }
}

TEST_P(NormalProjectionDepthForTip, ARayInwardsFromTheSurfaceCrossesTheTool) {
  // Whatever rounding says about the side of the surface on which the point lies.
  Random random(2);
  std::size_t inwards = 0;
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_on(tool, pose, random);
    const Vec3 normal = random.direction();
    const Vec3L a_little_on = point.cast<long double>() - 0.001L * tool.radius() * normal.cast<long double>();
    if (!collides(tool, pose, point) || test::slack(tool, pose, a_little_on) < 1e-12L) continue;
    ++inwards;
    const double depth = depth_at(tool, pose, point, normal);
    ASSERT_GE(depth, 0.001 * tool.radius());
    expect_exit(tool, pose, point, normal, depth);
  }
  EXPECT_GT(inwards, test::cases(100000) / 8);
}

TEST_P(NormalProjectionDepthForTip, HandlesRaysAlongAndAcrossTheAxis) {
  // Where one of (F.7), (F.12) has a zero denominator, and nearly so.
  Random random(3);
  for (std::size_t i = 0; i < test::cases(20000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose{Vec3::Zero(), random.uniform() < 0.5 ? Vec3(0, 0, -1) : Vec3(1, 0, 0)};
    const Vec3 point = test::random_point_near(tool, pose, random);
    if (test::slack(tool, pose, point.cast<long double>()) < 0.0L) continue;
    const double tiny = std::pow(10.0, random.uniform(-18.0, -3.0));
    for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, 0)}) {
      expect_exit(tool, pose, point, direction, depth_at(tool, pose, point, direction));
      const Vec3 nearly = (direction + tiny * random.direction()).normalized();
      expect_exit(tool, pose, point, nearly, depth_at(tool, pose, point, nearly));
    }
  }
}

// Dyadic sizes and a pose along the axes, so that the closed forms are exact.
constexpr double kUnit = 0x1p-13;
const ToolPose kPose{Vec3::Zero(), {0, 0, -1}};

TEST(NormalProjectionDepth, LeavesTheFlatToolThroughTheNearestSurfaceOnItsWay) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  const Vec3 point(kUnit, 0, 3 * kUnit);  // 3 units above the tip plane
  EXPECT_EQ(depth_at(tool, kPose, point, {-1, 0, 0}), 3 * kUnit) << "side, forwards";
  EXPECT_EQ(depth_at(tool, kPose, point, {1, 0, 0}), 5 * kUnit) << "side, across the axis";
  EXPECT_EQ(depth_at(tool, kPose, point, {0, 0, 1}), 3 * kUnit) << "tip";
  EXPECT_EQ(depth_at(tool, kPose, point, {0, 0, -1}), 13 * kUnit) << "bottom";
}

TEST(NormalProjectionDepth, LeavesTheRoundToolThroughTheHalfBall) {
  const Cylinder tool{5 * kUnit, 16 * kUnit, Tip::round};
  // Down along x = 3 units from 3 units above the tip plane: the ball is 4 units below it there.
  EXPECT_EQ(depth_at(tool, kPose, {3 * kUnit, 0, 3 * kUnit}, {0, 0, 1}), 7 * kUnit);
  // From inside the ball sideways, at 4 units below the plane: 3 units to its surface.
  EXPECT_EQ(depth_at(tool, kPose, {0, 0, -4 * kUnit}, {-1, 0, 0}), 3 * kUnit);
  // From inside the ball upwards: through the plane, which is no surface, to the bottom.
  EXPECT_EQ(depth_at(tool, kPose, {kUnit, 0, -2 * kUnit}, {0, 0, -1}), 18 * kUnit);
}

TEST(NormalProjectionDepth, OnlyPositiveExitsCount) {
  // The minimal positive value, thesis F.1: a point exactly on a surface whose ray points outwards there has passed it
  // already. It meets the next surface of (F.7), (F.9), (F.12) instead, beyond the body, or none.
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  EXPECT_EQ(depth_at(tool, kPose, {4 * kUnit, 0, 8 * kUnit}, {-1, 0, 0}), 0.0) << "side, straight out: none left";
  EXPECT_EQ(depth_at(tool, kPose, {kUnit, 0, 0}, {0, 0, 1}), 0.0) << "tip, straight out: none left";
  // From the tip plane downwards along 3 : 4, the infinite side wall is met after 5 units sideways 3.
  EXPECT_NEAR(depth_at(tool, kPose, {kUnit, 0, 0}, {-0.6, 0, 0.8}), 5 * kUnit, 4e-16 * kUnit * 16);
}

TEST(NormalProjectionDepth, IsNeverLongerThanTheTool) {
  // Points in the tip plane with rays almost along the axis meet the infinite side wall r / sin(angle) away.
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool{4 * kUnit, 16 * kUnit, tip};
    const double longest = tool.length() + 3.0 * tool.radius();  // beyond the longest way through the body
    for (double angle = 1.0; angle > 1e-18; angle *= 0.5) {
      for (const double down : {1.0, -1.0}) {
        const Vec3 normal(-std::sin(angle), 0, down * std::cos(angle));
        for (const double height : {0.0, 16 * kUnit}) {
          const double depth = depth_at(tool, kPose, {kUnit, 0, height}, normal);
          EXPECT_GE(depth, 0.0);
          EXPECT_LE(depth, longest) << "angle " << angle << ", height " << height;
        }
      }
    }
  }
}

TEST(NormalProjectionDepth, GrowsPastTheRadiusWhereSurfaceNormalSaturates) {
  // Thesis F.1: on a flat the depth is what the tool is pressed in by.
  for (const double pressed : {0.0001, 0.0004, 0.002, 0.005}) {
    EXPECT_EQ(depth_at(Cylinder{}, {{0, 0, -pressed}, {0, 0, -1}}, Vec3::Zero(), Vec3::UnitZ()), pressed);
  }
}

TEST(NormalProjectionDepth, OfAZeroNormalIsZero) {
  EXPECT_EQ(depth_at(Cylinder{}, kPose, {0, 0, 0.001}, Vec3::Zero()), 0.0);
}

}  // namespace
}  // namespace hapbench::normal_projection_depth_test
