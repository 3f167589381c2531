#include "algorithms/depth/shortest_distance.hpp"

#include <gtest/gtest.h>

#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::shortest_distance_test {
namespace {

using test::Vec3L;

struct Contact {
  double depth;
  Vec3 gradient;
};

Contact evaluate(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal = Vec3::UnitY()) {
  ContactBuffer contacts(1);
  contacts.push(0, point, normal);
  make_shortest_distance()->evaluate(tool, pose, contacts);
  return {contacts.depth[0], contacts.gradient(0)};
}

class ShortestDistanceForTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, ShortestDistanceForTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

// Coordinates up to 1 m are subtracted and turned: a few of their roundings, 1e-16 m each.
constexpr long double kTolerance = 1e-15L;

TEST_P(ShortestDistanceForTip, DepthIsTheDistanceToTheNearestSurface) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_near(tool, pose, random);
    const long double inside = test::slack(tool, pose, point.cast<long double>());
    if (inside < kTolerance) continue;
    // Inside a convex body the distance to the surface is the slack of the nearest constraint.
    ASSERT_NEAR(static_cast<double>(evaluate(tool, pose, point).depth - inside), 0.0, static_cast<double>(kTolerance));
  }
}

TEST_P(ShortestDistanceForTip, GradientLeadsOutOfTheToolInExactlyTheDepth) {
  Random random(2);
  for (std::size_t i = 0; i < test::cases(100000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 point = test::random_point_near(tool, pose, random);
    if (test::slack(tool, pose, point.cast<long double>()) < kTolerance) continue;
    const auto [depth, gradient] = evaluate(tool, pose, point);
    ASSERT_NEAR(gradient.norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
    // Only the shortest way out ends on the surface after that distance: any other direction stays inside. A radial
    // direction amplifies the rounding of the radial vector by r / |rho|, at most 1e6 for random points.
    const Vec3L way_out = point.cast<long double>() + depth * gradient.cast<long double>();
    ASSERT_NEAR(static_cast<double>(test::slack(tool, pose, way_out)), 0.0, 4e-15);
  }
}

// Dyadic sizes and a pose along the axes: every distance below is exact, so ties are real ties.
constexpr double kUnit = 0x1p-13;  // 0.12 mm
const Vec3 kAxis(0, 0, -1);
const ToolPose kPose{{0x1p-4, 0x1p-5, 0x1p-6}, kAxis};

/// The point s along the axis from the tip and a along +x, in units.
Vec3 at(double s, double a) {
  return kPose.position + kUnit * (s * kAxis + Vec3(a, 0, 0));
}

TEST(ShortestDistance, EachSurfaceOfTheFlatToolIsNearestToPointsBesideIt) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  const auto side = evaluate(tool, kPose, at(-8, 3));
  EXPECT_EQ(side.depth, kUnit);
  EXPECT_EQ(side.gradient, Vec3(1, 0, 0));
  const auto tip = evaluate(tool, kPose, at(-1, 1));
  EXPECT_EQ(tip.depth, kUnit);
  EXPECT_EQ(tip.gradient, kAxis);
  const auto bottom = evaluate(tool, kPose, at(-15, 1));
  EXPECT_EQ(bottom.depth, kUnit);
  EXPECT_EQ(bottom.gradient, Vec3(-kAxis));
}

TEST(ShortestDistance, TheRoundTipIsAHalfBallBeyondTheTipPlane) {
  const Cylinder tool{5 * kUnit, 16 * kUnit, Tip::round};
  // On the axis, one unit from the pole.
  const auto pole = evaluate(tool, kPose, at(4, 0));
  EXPECT_EQ(pole.depth, kUnit);
  EXPECT_EQ(pole.gradient, kAxis);
  // Nothing ends at the tip plane: on the axis just behind it the side is nearest, not the tip.
  const auto behind = evaluate(tool, kPose, at(-1, 4));
  EXPECT_EQ(behind.depth, kUnit);
  EXPECT_EQ(behind.gradient, Vec3(1, 0, 0));
  const auto bottom = evaluate(tool, kPose, at(-15, 1));
  EXPECT_EQ(bottom.depth, kUnit);
  EXPECT_EQ(bottom.gradient, Vec3(-kAxis));
}

TEST(ShortestDistance, TiesPreferTheSideThenTheTipThenTheBottom) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  EXPECT_EQ(evaluate(tool, kPose, at(-1, 3)).gradient, Vec3(1, 0, 0)) << "side and tip";
  EXPECT_EQ(evaluate(tool, kPose, at(-15, 3)).gradient, Vec3(1, 0, 0)) << "side and bottom";
  const Cylinder disc{4 * kUnit, 2 * kUnit, Tip::flat};
  EXPECT_EQ(evaluate(disc, kPose, at(-1, 1)).gradient, kAxis) << "tip and bottom";
  EXPECT_EQ(evaluate(disc, kPose, at(-1, 3)).gradient, Vec3(1, 0, 0)) << "all three";
  const Cylinder round{4 * kUnit, 16 * kUnit, Tip::round};
  EXPECT_EQ(evaluate(round, kPose, at(-15, 3)).gradient, Vec3(1, 0, 0)) << "side and bottom, round tip";
}

TEST(ShortestDistance, OnTheSurfaceTheDepthIsZeroAndTheGradientStillPointsOut) {
  const Cylinder tool{4 * kUnit, 16 * kUnit, Tip::flat};
  for (const auto& [s, a, gradient] :
       {std::tuple{-8.0, 4.0, Vec3(1, 0, 0)}, {0.0, 1.0, kAxis}, {-16.0, 1.0, Vec3(-kAxis)}}) {
    const auto contact = evaluate(tool, kPose, at(s, a));
    EXPECT_EQ(contact.depth, 0.0);
    EXPECT_EQ(contact.gradient, gradient);
  }
}

TEST(ShortestDistance, AnUndefinedDirectionFallsBackToTheInwardNormal) {
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  // On the median line the side is nearest, but in no direction.
  const Cylinder flat{kUnit, 16 * kUnit, Tip::flat};
  const auto on_axis = evaluate(flat, kPose, at(-8, 0), normal);
  EXPECT_EQ(on_axis.depth, kUnit);
  EXPECT_EQ(on_axis.gradient, Vec3(-normal));
  // The same at the centre of the round tip, in the cylinder (s = 0) and just inside the ball.
  const Cylinder round{kUnit, 16 * kUnit, Tip::round};
  EXPECT_EQ(evaluate(round, kPose, at(0, 0), normal).gradient, Vec3(-normal));
  const ToolPose origin{Vec3::Zero(), kAxis};
  EXPECT_EQ(evaluate(round, origin, 1e-13 * kUnit * kAxis, normal).gradient, Vec3(-normal));
}

TEST(ShortestDistance, DirectionsLongerThan1e12thOfTheRadiusAreDefined) {
  const ToolPose origin{Vec3::Zero(), kAxis};
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool{kUnit, 16 * kUnit, tip};
    const Vec3 middle = 8 * kUnit * -kAxis;
    EXPECT_EQ(evaluate(tool, origin, middle + Vec3(1.01e-12 * kUnit, 0, 0), normal).gradient, Vec3(1, 0, 0));
    EXPECT_EQ(evaluate(tool, origin, middle + Vec3(0.99e-12 * kUnit, 0, 0), normal).gradient, Vec3(-normal));
  }
}

TEST(ShortestDistance, DepthsAloneLeaveGradientsUntouched) {
  ContactBuffer contacts(1);
  contacts.push(0, at(-8, 3), Vec3::UnitY());
  contacts.set_gradient(0, {7, 8, 9});
  Cylinder(4 * kUnit, 16 * kUnit, Tip::flat).shortest_depths(kPose, contacts);
  EXPECT_EQ(contacts.depth[0], kUnit);
  EXPECT_EQ(contacts.gradient(0), Vec3(7, 8, 9));
}

}  // namespace
}  // namespace hapbench::shortest_distance_test
