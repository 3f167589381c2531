#include <gtest/gtest.h>

#include "tests/support/tool_geometry.hpp"

namespace hapbench::surface_constraints_test {
namespace {

constexpr Tip kTips[] = {Tip::flat, Tip::round};

/// Distance d_i = -g_i and normal m_i of one point.
struct Constraint {
  double distance;
  Vec3 normal;
};

Constraint constraint_of(const Cylinder& tool, const ToolPose& pose, const Vec3& point,
                         const Vec3& surface_normal = Vec3::UnitZ(), const Vec3& wanted = Vec3::Zero(),
                         double slack = 0.0) {
  ContactBuffer contacts(1);
  contacts.push(0, point, surface_normal);
  tool.surface_constraints(pose, wanted, slack, contacts);
  return {-contacts.depth[0], contacts.gradient(0)};
}

/// Tools, poses and points in, on and around the tool.
template <class Check>
void for_random_points(Check check) {
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    const Cylinder tool = test::random_tool(random, kTips[i % 2]);
    const ToolPose pose = test::random_pose(random);
    const Vec3 point =
        i % 5 == 0 ? test::random_point_on(tool, pose, random) : test::random_point_near(tool, pose, random);
    check(tool, pose, point, random);
  }
}

/// Coordinates of up to 1 m are rounded to 1e-16 of themselves, a few times over.
constexpr double kRounding = 4e-15;

TEST(SurfaceConstraints, HaveTheSignOfTheBodysDefinition) {
  for_random_points([](const Cylinder& tool, const ToolPose& pose, const Vec3& point, Random&) {
    const auto slack = static_cast<double>(test::slack(tool, pose, point.cast<long double>()));
    if (std::abs(slack) < kRounding) return;
    EXPECT_EQ(constraint_of(tool, pose, point).distance<0.0, slack> 0.0);
  });
}

TEST(SurfaceConstraints, LeadToTheSurfaceAlongTheNormal) {
  for_random_points([](const Cylinder& tool, const ToolPose& pose, const Vec3& point, Random&) {
    const Constraint c = constraint_of(tool, pose, point);
    ASSERT_NEAR(c.normal.norm(), 1.0, 4e-15);
    const Vec3 nearest = point - c.distance * c.normal;
    // Close to an edge's line the direction is as uncertain as rounding over distance; the place is not.
    EXPECT_NEAR(static_cast<double>(test::slack(tool, pose, nearest.cast<long double>())), 0.0, kRounding);
  });
}

TEST(SurfaceConstraints, AreSubgradientsOfAConvexFunction) {
  // Which, with the two above, makes it the signed distance: no place of the surface is nearer.
  for_random_points([](const Cylinder& tool, const ToolPose& pose, const Vec3& point, Random& random) {
    const Constraint c = constraint_of(tool, pose, point);
    for (int i = 0; i < 5; ++i) {
      const Vec3 other = i == 0 ? Vec3(point + 1e-6 * random.direction()) : test::random_point_near(tool, pose, random);
      const double distance = constraint_of(tool, pose, other).distance;
      EXPECT_GE(distance, c.distance + c.normal.dot(other - point) - kRounding);
    }
  });
}

TEST(SurfaceConstraints, ThatHoldKeepEveryPointOut) {
  Random random(2);
  int moves = 0;
  for_random_points([&](const Cylinder& tool, const ToolPose& pose, const Vec3& point, Random&) {
    const Vec3 move = 2e-3 * random.uniform() * random.direction();
    // Flush with the tip, with the bottom or with nothing; wanting to move there, so that planes take the place of
    // edges.
    const Vec3 normal =
        random.below(3) == 0 ? random.direction() : Vec3((random.below(2) == 0 ? 1.0 : -1.0) * pose.axis);
    const Constraint c = constraint_of(tool, pose, point, normal, move, 1e-5);
    if (c.normal.dot(move) > c.distance) return;
    ++moves;
    const ToolPose moved{pose.position + move, pose.axis};
    EXPECT_LE(static_cast<double>(test::slack(tool, moved, point.cast<long double>())), kRounding);
  });
  EXPECT_GT(moves, 5'000);
}

TEST(SurfaceConstraints, OnTheAxisTakeSomeNearestPlace) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  const ToolPose pose{Vec3::Zero(), -Vec3::UnitZ()};
  const Constraint middle = constraint_of(tool, pose, {0, 0, 0.005});
  EXPECT_EQ(middle.distance, -0.0005);
  EXPECT_NEAR(middle.normal.norm(), 1.0, 1e-15);
  EXPECT_EQ(middle.normal.z(), 0.0);
  const Constraint at_tip = constraint_of(tool, pose, {0, 0, 0.0001});
  EXPECT_EQ(at_tip.distance, -0.0001);
  EXPECT_EQ(at_tip.normal, pose.axis);
}

TEST(SurfaceConstraints, BeyondAnEdgeMeasureToTheEdge) {
  const Cylinder tool{0.5, 10.0, Tip::flat};
  const Constraint c = constraint_of(tool, {Vec3::Zero(), -Vec3::UnitZ()}, {0.5 + 0.3, 0.0, -0.4});
  EXPECT_NEAR(c.distance, 0.5, 1e-15);
  EXPECT_LE((c.normal - Vec3(0.6, 0.0, -0.8)).norm(), 1e-15);
}

}  // namespace
}  // namespace hapbench::surface_constraints_test
