#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "algorithms/registry.hpp"
#include "sim/contact/shell_query.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_geometry.hpp"

namespace hapbench {
namespace {

class EveryDepthModel : public testing::TestWithParam<DepthModelEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, EveryDepthModel, testing::ValuesIn(depth_models().begin(), depth_models().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

/// The colliding ones among points in, near and on the tool, found by the search and given depths by the model.
ContactBuffer contacts_of_random_scene(const DepthModelEntry& model, const Tool& tool, const ToolPose& pose,
                                       Random& random) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 50; ++i) {
    points.push_back({test::random_point_on(tool, pose, random), random.direction()});
    points.push_back({test::random_point_near(tool, pose, random), random.direction()});
  }
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  model.make()->evaluate(tool, pose, contacts);
  return contacts;
}

TEST_P(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  Random random(1);
  std::size_t on_surface = 0;
  for (std::size_t i = 0; i < test::cases(4000); ++i) {
    const Tool tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ToolPose pose = test::random_pose(random);
    const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, pose, random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_GE(contacts.depth[k], 0.0);
      ASSERT_TRUE(std::isfinite(contacts.depth[k]));
      on_surface += contacts.depth[k] < 1e-15;
    }
  }
  // The claim is about points that the search and the model could round differently: there were some.
  EXPECT_GT(on_surface, test::cases(4000));
}

TEST_P(EveryDepthModel, GradientsAreUnitVectors) {
  Random random(2);
  for (std::size_t i = 0; i < test::cases(1000); ++i) {
    const Tool tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, test::random_pose(random), random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_NEAR(contacts.gradient(k).norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
    }
  }
}

TEST_P(EveryDepthModel, PadsItsContacts) {
  Random random(3);
  const Tool tool;
  ContactBuffer contacts(8);
  for (int i = 0; i < 8; ++i) contacts.push(0, {0, 0, 0.001}, random.direction());
  contacts.shrink(5);
  GetParam().make()->evaluate(tool, {}, contacts);
  for (std::size_t i = 5; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
}

TEST_P(EveryDepthModel, KeepsPointsNormalsAndIndices) {
  Random random(4);
  const Tool tool;
  const ToolPose pose = test::random_pose(random);
  const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, pose, random);
  ContactBuffer again = contacts;
  GetParam().make()->evaluate(tool, pose, again);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    EXPECT_EQ(again.index[k], contacts.index[k]);
    EXPECT_EQ(again.point(k), contacts.point(k));
    EXPECT_EQ(again.normal(k), contacts.normal(k));
    EXPECT_EQ(again.depth[k], contacts.depth[k]);
    EXPECT_EQ(again.gradient(k), contacts.gradient(k));
  }
}

}  // namespace
}  // namespace hapbench
