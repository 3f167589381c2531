#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
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

TEST(SurfaceNormal, HasTheDepthOfShortestDistanceAndTheInwardNormalAsGradient) {
  Random random(1);
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Cylinder tool = test::random_tool(random, tip);
    const ToolPose pose = test::random_pose(random);
    ContactBuffer contacts(1000);
    while (contacts.size() < contacts.capacity()) {
      const Vec3 point = test::random_point_near(tool, pose, random);
      if (test::slack(tool, pose, point.cast<long double>()) < 0.0L) continue;
      contacts.push(static_cast<std::uint32_t>(contacts.size()), point, random.direction());
    }
    ContactBuffer shortest = contacts;
    make_depth_model("surface_normal")->evaluate(tool, pose, contacts);
    make_depth_model("shortest_distance")->evaluate(tool, pose, shortest);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.depth[i], shortest.depth[i]);
      EXPECT_EQ(contacts.gradient(i), Vec3(-contacts.normal(i)));
    }
  }
}

class EveryDepthModel : public testing::TestWithParam<DepthModelEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, EveryDepthModel, testing::ValuesIn(depth_models().begin(), depth_models().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

/// A model of a shell of so many points.
std::unique_ptr<DepthModel> prepared(const DepthModelEntry& entry, std::size_t points) {
  std::unique_ptr<DepthModel> model = entry.make();
  model->prepare(PointShell(std::vector<SurfacePoint>(points), 0.0));
  return model;
}

TEST_P(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  Random random(1);
  std::size_t on_surface = 0;
  for (std::size_t i = 0; i < test::cases(4000); ++i) {
    const Cylinder tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ToolPose pose = test::random_pose(random);
    std::vector<SurfacePoint> points;
    while (points.size() < 100) {
      points.push_back({test::random_point_on(tool, pose, random), random.direction()});
      points.push_back({test::random_point_near(tool, pose, random), random.direction()});
    }
    const PointShell shell(points, 0.0);
    ShellQuery query(shell, tool);
    ContactBuffer contacts(query.capacity());
    query.contacts_at(pose, contacts);
    prepared(GetParam(), points.size())->evaluate(tool, pose, contacts);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_GE(contacts.depth[k], 0.0);
      ASSERT_TRUE(std::isfinite(contacts.depth[k]));
      on_surface += contacts.depth[k] < 1e-15;
    }
  }
  // There were points that the search and the model could round differently.
  EXPECT_GT(on_surface, test::cases(4000));
}

TEST_P(EveryDepthModel, PadsItsContacts) {
  Random random(3);
  const Cylinder tool;
  ContactBuffer contacts(8);
  for (int i = 0; i < 8; ++i) contacts.push(0, {0, 0, 0.001}, random.direction());
  contacts.shrink(5);
  prepared(GetParam(), contacts.capacity())->evaluate(tool, {}, contacts);
  for (std::size_t i = 5; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
}

}  // namespace
}  // namespace hapbench::depth_model_test
