#include "sim/tool/cylinder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

/// Properties of cylinders alone; EveryTool tests those of any tool.
namespace hapbench::cylinder_test {
namespace {

using test::cases;

/// Coordinates of up to 1 m are rounded to 1e-16 of themselves, a few times over.
constexpr double kRounding = 4e-15;

TEST(LargestSquareWithin, IsTheLastSquareWhoseRootDoesNotExceedTheRadius) {
  Random random(3);
  constexpr double up = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cases(100000); ++i) {
    const double r = std::pow(10.0, random.uniform(-9.0, 3.0));
    const double square = largest_square_within(r);
    ASSERT_LE(std::sqrt(square), r);
    ASSERT_GT(std::sqrt(std::nextafter(square, up)), r);
  }
}

/// Distance -d_i and normal m_i of one point.
struct Constraint {
  double distance;
  Vec3 normal;
};

Constraint constraint_of(const Cylinder& tool, const ToolPose& pose, const Vec3& point) {
  ContactBuffer contacts(1);
  contacts.push(0, point, Vec3::UnitZ());
  tool.surface_constraints(pose, Vec3::Zero(), 0.0, contacts);
  return {-contacts.depth[0], contacts.gradient(0)};
}

TEST(CylinderConstraints, AreSignedDistancesHoweverShortTheCylinder) {
  Random random(1);
  for (std::size_t i = 0; i < cases(20'000); ++i) {
    const double radius = random.uniform(1e-4, 1e-3);
    const Cylinder tool(radius, random.uniform(0.2, 2.0) * radius, i % 2 == 0 ? Tip::flat : Tip::round);
    const ToolPose pose = test::random_pose(random);
    const auto slack = [&](const Vec3& point) {
      return static_cast<double>(test::slack(tool, pose, point.cast<long double>()));
    };
    const Vec3 point =
        i % 5 < 2 ? test::random_point_on(tool, pose, random) : test::random_point_near(tool, pose, random);
    const Constraint c = constraint_of(tool, pose, point);
    if (std::abs(slack(point)) > kRounding) {
      ASSERT_EQ(std::signbit(c.distance), slack(point) > 0.0);
    }
    ASSERT_NEAR(c.normal.norm(), 1.0, kRounding);
    // Close to an edge's line the direction is as uncertain as rounding over distance; the place is not.
    ASSERT_NEAR(slack(point - c.distance * c.normal), 0.0, kRounding);
    // Subgradients of a convex function: with the two above, no place of the surface is nearer.
    for (int k = 0; k < 5; ++k) {
      const Vec3 other = k == 0 ? Vec3(point + 1e-6 * random.direction()) : test::random_point_near(tool, pose, random);
      ASSERT_GE(constraint_of(tool, pose, other).distance, c.distance + c.normal.dot(other - point) - kRounding);
    }
  }
}

TEST(CylinderConstraints, OnTheAxisTakeSomeNearestPlace) {
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

TEST(CylinderConstraints, BeyondAnEdgeMeasureToTheEdge) {
  const Cylinder tool{0.5, 10.0, Tip::flat};
  const Constraint c = constraint_of(tool, {Vec3::Zero(), -Vec3::UnitZ()}, {0.5 + 0.3, 0.0, -0.4});
  EXPECT_NEAR(c.distance, 0.5, 1e-15);
  EXPECT_LE((c.normal - Vec3(0.6, 0.0, -0.8)).norm(), 1e-15);
}

}  // namespace
}  // namespace hapbench::cylinder_test
