#include "algorithms/proxy/proxy_constraints.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench::proxy_constraints_test {
namespace {

const SpringSet kSprings{{{1, 0, 0}, {0, 0, 1}}, true};

TEST(SpringConstraints, OfABilateralSpringHoldTheToolFromBothSides) {
  SpringConstraints constraints(kSprings);
  ContactBuffer contacts(constraints.capacity());
  ASSERT_EQ(constraints.capacity(), 4u);
  constraints.constraints_at({{0.25, 0.0, -0.5}}, Vec3::Zero(), contacts);
  ASSERT_EQ(contacts.size(), 4u);
  const double depths[] = {0.25, -0.25, -0.5, 0.5};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(contacts.index[i], i / 2);
    EXPECT_EQ(contacts.depth[i], depths[i]);
    EXPECT_EQ(contacts.gradient(i), Vec3((i % 2 == 0 ? 1.0 : -1.0) * kSprings.gradients[i / 2]));
  }
  EXPECT_EQ(constraints.work().points_tested, 2u);
}

TEST(SpringConstraints, OfAUnilateralSpringHoldFromOneSideAtAnyDistance) {
  const SpringSet springs{kSprings.gradients, false};
  SpringConstraints constraints(springs);
  ContactBuffer contacts(constraints.capacity());
  constraints.constraints_at({{-7.0, 0.0, 0.5}}, Vec3::Zero(), contacts);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts.depth[0], -7.0);
  EXPECT_EQ(constraints.margin(), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(constraints.act_at_points());
  constraints.constraints_at({Vec3::Constant(std::numeric_limits<double>::quiet_NaN())}, Vec3::Zero(), contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(ShellConstraints, AreThoseOfEveryPointWithinTheMargin) {
  const Cylinder tool;
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0);
  for (const Skips skips : {Skips::on, Skips::off}) {
    ShellConstraints constraints(shell, tool, skips);
    EXPECT_EQ(constraints.margin(), kProxyMargin * tool.radius());
    ContactBuffer contacts(constraints.capacity());
    // The tip plane is half a margin above the plane of the points.
    const double height = 0.5 * constraints.margin();
    constraints.constraints_at({{0.0, 0.0, height}}, -Vec3::UnitZ(), contacts);
    std::vector<bool> found(shell.size(), false);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      found[contacts.index[i]] = true;
      EXPECT_LE(contacts.depth[i], -height + 1e-18);
    }
    std::size_t below = 0;
    for (std::size_t i = 0; i < shell.size(); ++i) {
      if (shell.point(i).position.norm() > tool.radius()) continue;
      EXPECT_TRUE(found[i]);
      ++below;
    }
    EXPECT_GT(below, 50u);
    constraints.constraints_at({{0.0, 0.0, 0.001}}, -Vec3::UnitZ(), contacts);
    EXPECT_TRUE(contacts.empty());
  }
}

}  // namespace
}  // namespace hapbench::proxy_constraints_test
