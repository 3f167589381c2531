#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "algorithms/registry.hpp"
#include "sim/contact/contact_query.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::every_depth_model_test {
namespace {

class EveryDepthModel : public testing::TestWithParam<DepthModelEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, EveryDepthModel, testing::ValuesIn(depth_models().begin(), depth_models().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

constexpr std::size_t kPoints = 100;

/// A model of its own, as at the start of a run.
std::unique_ptr<DepthModel> prepared(const DepthModelEntry& entry) {
  const PointShell shell(std::vector<SurfacePoint>(kPoints), 0.0);
  std::unique_ptr<DepthModel> model = entry.make();
  model->prepare(shell);
  return model;
}

/// The colliding ones among points in, near and on the tool, found by the search and given depths by the model.
ContactBuffer contacts_of_random_scene(const DepthModelEntry& model, const Cylinder& tool, const ToolPose& pose,
                                       Random& random) {
  std::vector<SurfacePoint> points;
  while (points.size() < kPoints) {
    points.push_back({test::random_point_on(tool, pose, random), random.direction()});
    points.push_back({test::random_point_near(tool, pose, random), random.direction()});
  }
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  prepared(model)->evaluate(tool, pose, contacts);
  return contacts;
}

TEST_P(EveryDepthModel, NeverGivesACollidingPointANegativeDepth) {
  Random random(1);
  std::size_t on_surface = 0;
  for (std::size_t i = 0; i < test::cases(4000); ++i) {
    const Cylinder tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
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
    const Cylinder tool = test::random_tool(random, i % 2 == 0 ? Tip::flat : Tip::round);
    const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, test::random_pose(random), random);
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      ASSERT_NEAR(contacts.gradient(k).norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
    }
  }
}

TEST_P(EveryDepthModel, PadsItsContacts) {
  Random random(3);
  const Cylinder tool;
  ContactBuffer contacts(8);
  for (int i = 0; i < 8; ++i) contacts.push(0, {0, 0, 0.001}, random.direction());
  contacts.shrink(5);
  prepared(GetParam())->evaluate(tool, {}, contacts);
  for (std::size_t i = 5; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
}

TEST_P(EveryDepthModel, KeepsPointsNormalsAndIndices) {
  Random random(4);
  const Cylinder tool;
  const ToolPose pose = test::random_pose(random);
  const ContactBuffer contacts = contacts_of_random_scene(GetParam(), tool, pose, random);
  ContactBuffer again = contacts;
  prepared(GetParam())->evaluate(tool, pose, again);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    EXPECT_EQ(again.index[k], contacts.index[k]);
    EXPECT_EQ(again.point(k), contacts.point(k));
    EXPECT_EQ(again.normal(k), contacts.normal(k));
    EXPECT_EQ(again.depth[k], contacts.depth[k]);
    EXPECT_EQ(again.gradient(k), contacts.gradient(k));
  }
}

/// Depths of all contacts after the tool has gone through the poses; with `rests` steps without contacts before the
/// last.
AlignedDoubles depths_after(DepthModel& model, const Cylinder& tool, std::initializer_list<ToolPose> poses, int rests) {
  Random random(5);
  std::vector<SurfacePoint> points;
  while (points.size() < kPoints) points.push_back({test::random_point_near(tool, {}, random), random.direction()});
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  for (const ToolPose& pose : poses) {
    if (&pose == poses.end() - 1) {
      contacts.clear();
      for (int i = 0; i < rests; ++i) model.evaluate(tool, {{1, 1, 1}, {0, 0, -1}}, contacts);
    }
    query.contacts_at(pose, contacts);
    model.evaluate(tool, pose, contacts);
  }
  EXPECT_GT(contacts.size(), 10u);
  AlignedDoubles depths = contacts.depth;
  depths.resize(contacts.size());
  return depths;
}

const ToolPose kHere, kThere{{0.0001, 0.0001, -0.0002}, Vec3(0.02, 0.03, -1.0).normalized()};

TEST_P(EveryDepthModel, IsAfterResetWhatItWasAtTheStart) {
  const Cylinder tool;
  const auto model = prepared(GetParam());
  const AlignedDoubles first = depths_after(*model, tool, {kHere, kThere}, 0);
  model->reset();
  EXPECT_EQ(depths_after(*model, tool, {kHere, kThere}, 0), first);
}

TEST_P(EveryDepthModel, LearnsNothingFromASecondStepWithoutContacts) {
  const Cylinder tool;
  const AlignedDoubles once = depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 1);
  EXPECT_EQ(depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 2), once);
  EXPECT_EQ(depths_after(*prepared(GetParam()), tool, {kHere, kThere}, 100), once);
}

}  // namespace
}  // namespace hapbench::every_depth_model_test
