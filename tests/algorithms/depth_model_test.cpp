#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::depth_model_test {
namespace {

struct Contact {
  double depth;
  Vec3 gradient;
};

Contact evaluate(const Cylinder& tool, const ToolPose& pose, const Vec3& point, const Vec3& normal = Vec3::UnitY()) {
  ContactBuffer contacts(1);
  contacts.push(0, point, normal);
  make_depth_model("shortest_distance")->evaluate(tool, pose, contacts);
  return {contacts.depth[0], contacts.gradient(0)};
}

// Dyadic sizes and a pose along the axes: every distance below is exact, so ties are real ties.
constexpr double kUnit = 0x1p-13;  // 0.12 mm
const Vec3 kAxis(0, 0, -1);
const ToolPose kPose{{0x1p-4, 0x1p-5, 0x1p-6}, kAxis};

/// The point s along the axis from the tip and a along +x, in units.
Vec3 at(double s, double a) {
  return kPose.position + kUnit * (s * kAxis + Vec3(a, 0, 0));
}

TEST(ShortestDistance, AnUndefinedDirectionFallsBackToTheInwardNormal) {
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  // On the median line the side is nearest, in an undefined direction.
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

/// Calls check(tool, pose, shell, contacts) with cylinders of both tips among points in, on and around them.
template <class Check>
void for_tools(std::size_t n, Check check) {
  Random random(1);
  for (std::size_t i = 0; i < test::cases(n); ++i) {
    const test::DefinedTool tool = test::tool_kinds()[i % 2].make(random, 0.001);
    const ToolPose pose = test::random_pose(random);
    std::vector<SurfacePoint> points;
    while (points.size() < 100) {
      points.push_back({tool.surface_point(pose, random), random.direction()});
      points.push_back({tool.near_point(pose, random), random.direction()});
    }
    const PointShell shell(points, 0.0);
    ShellQuery query(shell, *tool.shape);
    ContactBuffer contacts(query.capacity());
    query.contacts_at(pose, contacts);
    check(*tool.shape, pose, shell, contacts);
  }
}

TEST(SurfaceNormal, HasTheDepthOfShortestDistanceAndTheInwardNormalAsGradient) {
  for_tools(400, [](const ToolShape& tool, const ToolPose& pose, const PointShell&, ContactBuffer& contacts) {
    ContactBuffer shortest = contacts;
    make_depth_model("surface_normal")->evaluate(tool, pose, contacts);
    make_depth_model("shortest_distance")->evaluate(tool, pose, shortest);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.depth[i], shortest.depth[i]);
      EXPECT_EQ(contacts.gradient(i), Vec3(-contacts.normal(i)));
    }
  });
}

TEST(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  for (const DepthModelEntry& model : depth_models()) {
    SCOPED_TRACE(model.info->name);
    std::size_t on_surface = 0;
    for_tools(4000, [&](const ToolShape& tool, const ToolPose& pose, const PointShell& shell, ContactBuffer& contacts) {
      const auto made = model.make();
      made->prepare(shell);
      made->evaluate(tool, pose, contacts);
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        ASSERT_GE(contacts.depth[k], 0.0);
        ASSERT_TRUE(std::isfinite(contacts.depth[k]));
        on_surface += contacts.depth[k] < 1e-15;
      }
    });
    // There were points that the search and the model could round differently.
    EXPECT_GT(on_surface, test::cases(4000));
  }
}

}  // namespace
}  // namespace hapbench::depth_model_test
