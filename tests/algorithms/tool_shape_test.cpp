#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "results/allocations/allocations.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/tool_shape.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

/// A tool shape that only this test knows, and tools of a mesh, in depth models and algorithms.
namespace hapbench::tool_shape_test {
namespace {

using test::Brick;
using test::cases;

constexpr double kSpacing = 0.0001;

ToolPose random_pose(Random& random) {
  return {0.001 * random.direction(), random.direction(), random.uniform(-3.0, 3.0)};
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
  // Rolled, so that the brick does not stand parallel to the rows of points.
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
  // Some of the shortest ways out lead through a side.
  EXPECT_LE(std::hypot(force.spring.x(), force.spring.y()), 0.05 * force.spring.z());
}

/// Lowers a tool from `start` by 50 µm per step into a shell under the proxy algorithm and expects that the proxy stays
/// out: `deepest(pose)` [m], the largest depth of a shell point in the tool at a pose, is rounding.
template <class Deepest>
void expect_proxy_stays_out(const ToolShape& tool, const PointShell& shell, const ToolPose& start, int steps,
                            const Deepest& deepest) {
  RenderingConfig config;
  config.algorithm = "proxy";
  ShellSource source(shell, tool, make_contact_query(shell, tool, Skips::on), make_depth_model(config));
  ContactBuffer contacts(source.capacity());
  const auto proxy = make_algorithm(config);
  proxy->prepare({source.capacity(), &tool, &shell});
  proxy->reset();
  RenderedForce force;
  ToolPose pose = start;
  for (int k = 0; k < steps; ++k) {
    pose.position.z() = start.position.z() - 0.00005 * k;
    source.contacts_at(pose, contacts);
    proxy->compute({pose, Vec3::Zero()}, contacts, force);
    ASSERT_LE(deepest({pose.position + force.spring / config.stiffness, pose.axis, pose.roll}), 1e-9) << "step " << k;
  }
  EXPECT_GT(force.spring.z(), 0.0);
}

/// An axis that points down and leans by at most half a radian.
Vec3 leaning_axis(Random& random) {
  return (Vec3(0, 0, -1) + 0.5 * random.direction()).normalized();
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
      long double most = -std::numeric_limits<long double>::infinity();
      for (std::size_t k = 0; k < shell.size(); ++k)
        most = std::max(most, tool.slack(pose, shell.point(k).position.cast<long double>()));
      return static_cast<double>(most);
    };
    expect_proxy_stays_out(*tool.shape, shell, {{0.0, 0.0, 0.002}, leaning_axis(random)}, 60, deepest);
    ++runs;
  }
  EXPECT_GT(runs, cases(100) / 4);
}

/// A drill of 32 sides, a sphere and, concave, a cup, 1 mm wide.
const std::vector<std::shared_ptr<const MeshTool>>& tools() {
  static const auto all = [] {
    std::vector<std::shared_ptr<const MeshTool>> made;
    for (const TriangleSoup& soup :
         {test::cylinder_mesh(0.0005, 0.003, 32), test::scaled(test::sphere(1.0, 3), 0.0005, {0, 0, 0.0005}),
          test::scaled(test::cup(24), 0.0005)}) {
      made.push_back(std::make_shared<MeshTool>(test::grid_of(soup, 0.00004)));
    }
    return made;
  }();
  return all;
}

class MeshToolInEveryAlgorithm : public testing::TestWithParam<AlgorithmEntry> {};
INSTANTIATE_TEST_SUITE_P(Registered, MeshToolInEveryAlgorithm,
                         testing::ValuesIn(algorithms().begin(), algorithms().end()),
                         [](const auto& entry) { return std::string(entry.param.info->name); });

TEST_P(MeshToolInEveryAlgorithm, IsPushedOutOfAPlaneWithoutAllocating) {
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  for (const auto& tool : tools()) {
    for (const DepthModelEntry& model : depth_models()) {
      RenderingConfig config;
      config.algorithm = GetParam().info->name;
      if (GetParam().fixed_depth_model.empty()) config.depth_model = model.info->name;
      ShellSource source(shell, *tool, make_contact_query(shell, *tool, Skips::on), make_depth_model(config));
      ContactBuffer contacts(source.capacity());
      const auto algorithm = make_algorithm(config);
      algorithm->prepare({source.capacity(), tool.get(), &shell});
      algorithm->reset();
      RenderedForce force;
      const AllocationCount allocations;
      for (int k = 0; k < 20; ++k) {
        const ToolPose pose{{0.00002, -0.00001, 0.0001 - 0.000007 * k}, Vec3(0.05, 0.02, -1.0).normalized(), 0.1 * k};
        source.contacts_at(pose, contacts);
        algorithm->compute({pose, Vec3::Zero()}, contacts, force);
        ASSERT_TRUE(force.spring.allFinite());
      }
      EXPECT_EQ(allocations.value(), 0u);
      // The tools lean by 3 degrees and edges are near, so some springs point aside, but their sum points up. Half-way
      // through the bottom of the cup, 75 um deep, the shortest way out would lead into the cup.
      EXPECT_GT(force.spring.z(), 0.0) << model.info->name;
    }
  }
}

TEST(Proxy, KeepsEveryPointOutOfANewShapeAndConvexMeshes) {
  Random random(3);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  ContactBuffer all(shell.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    all.push(static_cast<std::uint32_t>(i), shell.point(i).position, shell.point(i).normal);
  }
  std::vector<std::shared_ptr<const ToolShape>> shapes(tools().begin(), tools().end());
  shapes.push_back(std::make_shared<Brick>(0.0003, 0.0008, 0.002));
  for (const auto& tool : shapes) {
    if (!tool->convex()) continue;
    const auto deepest = [&](const ToolPose& pose) {
      tool->shortest_depths(pose, all);
      return *std::max_element(all.depth.begin(), all.depth.begin() + static_cast<std::ptrdiff_t>(all.size()));
    };
    for (std::size_t run = 0; run < cases(20); ++run) {
      const Vec3 axis = leaning_axis(random);
      const ToolPose start{{0.0, 0.0, 0.001}, axis, random.uniform(-3.0, 3.0)};
      expect_proxy_stays_out(*tool, shell, start, 40, deepest);
    }
  }
}

}  // namespace
}  // namespace hapbench::tool_shape_test
