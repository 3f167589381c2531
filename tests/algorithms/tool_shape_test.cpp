#include "sim/tool/tool_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/registry.hpp"
#include "algorithms/shell_source.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/algorithms/proxy_descent.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

/// A shape that nothing but this test knows goes through searches, depth models and algorithms: the interface is all
/// that they ask of a tool.
namespace hapbench::tool_shape_test {
namespace {

using test::Brick;
using test::cases;

constexpr double kSpacing = 0.0001;

/// Another pose after a small step, a small turn and a small roll.
ToolPose next_pose(ToolPose pose, Random& random) {
  pose.position += 0.00004 * random.uniform() * random.direction();
  pose.axis = (pose.axis + 0.02 * random.uniform() * random.direction()).normalized();
  pose.roll += 0.03 * random.uniform(-1.0, 1.0);
  return pose;
}

ToolPose random_pose(Random& random) {
  return {0.001 * random.direction(), random.direction(), random.uniform(-3.0, 3.0)};
}

template <class Query>
class EverySearch : public testing::Test {};
using Searches = testing::Types<ShellQuery, GridQuery, NeighbourListQuery>;
TYPED_TEST_SUITE(EverySearch, Searches);

TYPED_TEST(EverySearch, FindsThePointsInANewShape) {
  Random random(1);
  const Brick brick(0.0003, 0.0008, 0.002);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  TypeParam query(shell, brick);
  ContactBuffer contacts(query.capacity());
  std::uint64_t found = 0;
  for (std::size_t walk = 0; walk < cases(40); ++walk) {
    ToolPose pose = random_pose(random);
    for (int k = 0; k < 50; ++k, pose = next_pose(pose, random)) {
      query.contacts_at(pose, contacts);
      found += contacts.size();
      std::size_t next = 0;
      for (std::size_t i = 0; i < shell.size(); ++i) {
        const bool inside = brick.slack(pose, shell.point(i).position) >= 0.0;
        ASSERT_EQ(next < contacts.size() && contacts.index[next] == i, inside) << i;
        next += inside;
      }
    }
  }
  EXPECT_GT(found, cases(40) * 500);
}

class NewShapeInEveryDepthModel : public testing::TestWithParam<DepthModelEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, NewShapeInEveryDepthModel,
                         testing::ValuesIn(depth_models().begin(), depth_models().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

TEST_P(NewShapeInEveryDepthModel, HasItsDepthsBetweenTheShortestWayOutAndTheOneAlongTheGradient) {
  Random random(2);
  const Brick brick(0.0003, 0.0008, 0.002);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  ShellQuery query(shell, brick);
  ContactBuffer contacts(query.capacity());
  std::vector<double> exits(query.capacity());
  std::uint64_t checked = 0;
  for (std::size_t i = 0; i < cases(200); ++i) {
    const ToolPose pose = random_pose(random);
    const auto model = GetParam().make();
    model->prepare(shell);
    query.contacts_at(pose, contacts);
    model->evaluate(brick, pose, contacts);
    brick.exit_distances(pose, contacts, exits.data());
    for (std::size_t k = 0; k < contacts.size(); ++k, ++checked) {
      ASSERT_NEAR(contacts.gradient(k).norm(), 1.0, 1e-14);
      ASSERT_GE(contacts.depth[k], brick.slack(pose, contacts.point(k)) - 1e-15);
      ASSERT_LE(contacts.depth[k], exits[k] + 1e-15);
    }
  }
  EXPECT_GT(checked, cases(200) * 10);
}

class NewShapeInEveryAlgorithm : public testing::TestWithParam<AlgorithmEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, NewShapeInEveryAlgorithm,
                         testing::ValuesIn(algorithms().begin(), algorithms().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

TEST_P(NewShapeInEveryAlgorithm, IsPushedOutOfAPlane) {
  // Rolled, or the brick would stand parallel to the rows of points.
  const ToolPose pose{{0.00002, -0.00001, -0.00005}, {0.0, 0.0, -1.0}, 0.4};
  const Brick brick(0.0003, 0.0008, 0.002);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  RenderingConfig config;
  config.algorithm = GetParam().info->name;
  ShellSource source(shell, brick, make_contact_query(shell, brick, Skips::on), make_depth_model(config));
  ContactBuffer contacts(source.capacity());
  const auto algorithm = make_algorithm(config);
  algorithm->prepare({source.capacity(), &brick, &shell});
  algorithm->reset();
  RenderedForce force;
  for (const double height : {0.0001, pose.position.z()}) {  // a proxy has to start outside
    const ToolPose now{{pose.position.x(), pose.position.y(), height}, pose.axis, pose.roll};
    source.contacts_at(now, contacts);
    algorithm->compute({now, Vec3::Zero()}, contacts, force);
    if (height > 0.0) {
      EXPECT_EQ(force.spring, Vec3(0, 0, 0));
    }
  }
  EXPECT_NEAR(force.depth_max, 0.00005, 1e-15);
  EXPECT_GT(force.spring.z(), 0.5 * config.stiffness * force.depth_max / static_cast<double>(contacts.size()));
  // Of the shortest ways out, some lead through a side.
  EXPECT_LE(std::hypot(force.spring.x(), force.spring.y()), 0.05 * force.spring.z());
}

/// The largest slack of a point of the shell; positive inside.
template <class Slack>
double largest(const PointShell& shell, const Slack& slack) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i) most = std::max(most, slack(shell.point(i).position));
  return most;
}

TEST(Proxy, KeepsEveryPointOutOfANewShape) {
  Random random(3);
  const Brick brick(0.0003, 0.0008, 0.002);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  const auto deepest = [&](const ToolPose& pose) {
    return largest(shell, [&](const Vec3& point) { return brick.slack(pose, point); });
  };
  for (std::size_t run = 0; run < cases(20); ++run) {
    const Vec3 axis = test::leaning_axis(random);
    const ToolPose start{{0.0, 0.0, 0.001}, axis, random.uniform(-3.0, 3.0)};
    test::expect_proxy_stays_out(brick, shell, start, 40, deepest);
  }
}

TEST(Proxy, KeepsEveryPointOutOfConvexSolidsOfRevolution) {
  Random random(4);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  std::size_t runs = 0;
  for (std::size_t i = 0; i < cases(100); ++i) {
    const test::DefinedTool tool = test::tool_kinds()[i % test::tool_kinds().size()].make(random, 0.001);
    if (!tool.shape->convex()) continue;
    SCOPED_TRACE(i);
    const auto deepest = [&](const ToolPose& pose) {
      return largest(
          shell, [&](const Vec3& point) { return static_cast<double>(tool.slack(pose, point.cast<long double>())); });
    };
    test::expect_proxy_stays_out(*tool.shape, shell, {{0.0, 0.0, 0.002}, test::leaning_axis(random)}, 60, deepest);
    ++runs;
  }
  EXPECT_GT(runs, cases(100) / 4);
}

}  // namespace
}  // namespace hapbench::tool_shape_test
