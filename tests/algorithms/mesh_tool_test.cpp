#include "sim/tool/mesh_tool.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "algorithms/registry.hpp"
#include "algorithms/shell_source.hpp"
#include "results/allocations/allocations.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/algorithms/proxy_descent.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Tools of a mesh under every algorithm and depth model.
namespace hapbench::mesh_tool_test {
namespace {

using test::cases;

constexpr double kSpacing = 0.0001;

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
      // The tools lean by 3 degrees and edges are near: some springs lead aside, their sum up. Half-way
      // through the cup's bottom, 75 um deep, the shortest way out would lead into the cup.
      EXPECT_GT(force.spring.z(), 0.0) << model.info->name;
    }
  }
}

TEST(Proxy, KeepsEveryPointOutOfAConvexMesh) {
  Random random(3);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  ContactBuffer all(shell.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    all.push(static_cast<std::uint32_t>(i), shell.point(i).position, shell.point(i).normal);
  }
  for (const auto& tool : tools()) {
    if (!tool->convex()) continue;
    const auto deepest = [&](const ToolPose& pose) {
      tool->shortest_depths(pose, all);
      return *std::max_element(all.depth.begin(), all.depth.begin() + static_cast<std::ptrdiff_t>(all.size()));
    };
    for (std::size_t run = 0; run < cases(20); ++run) {
      const Vec3 axis = test::leaning_axis(random);
      const ToolPose start{{0.0, 0.0, 0.001}, axis, random.uniform(-3.0, 3.0)};
      test::expect_proxy_stays_out(*tool, shell, start, 40, deepest);
    }
  }
}

}  // namespace
}  // namespace hapbench::mesh_tool_test
