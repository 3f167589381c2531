#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "results/allocations/allocations.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Tools of a mesh, which are no solids of revolution, in depth models and algorithms.
namespace hapbench::tool_shape_test {
namespace {

using test::cases;

constexpr double kSpacing = 0.0001;

/// A drill of 32 sides, a sphere, a box and, concave, a cup, 1 mm wide.
const std::vector<std::shared_ptr<const MeshTool>>& tools() {
  static const auto all = [] {
    std::vector<std::shared_ptr<const MeshTool>> made;
    TriangleSoup box = test::cube(0.5, {0, 0, 0.5});
    for (Vec3& v : box.vertices) v = v.cwiseProduct(Vec3(0.0006, 0.001, 0.002));
    for (const TriangleSoup& soup :
         {test::cylinder_mesh(0.0005, 0.003, 32), test::scaled(test::sphere(1.0, 3), 0.0005, {0, 0, 0.0005}), box,
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

TEST(Proxy, KeepsEveryPointOutOfConvexMeshes) {
  Random random(3);
  const PointShell shell(surface_points(Plane{0.004, kSpacing}), kSpacing);
  ContactBuffer all(shell.size());
  for (std::size_t i = 0; i < shell.size(); ++i) {
    all.push(static_cast<std::uint32_t>(i), shell.point(i).position, shell.point(i).normal);
  }
  RenderingConfig config;
  config.algorithm = "proxy";
  for (const auto& tool : tools()) {
    if (!tool->convex()) continue;
    ShellSource source(shell, *tool, make_contact_query(shell, *tool, Skips::on), make_depth_model(config));
    ContactBuffer contacts(source.capacity());
    const auto proxy = make_algorithm(config);
    proxy->prepare({source.capacity(), tool.get(), &shell});
    for (std::size_t run = 0; run < cases(20); ++run) {
      // Lowered by 50 um in each step, with an axis that leans by at most half a radian.
      const Vec3 axis = (Vec3(0, 0, -1) + 0.5 * random.direction()).normalized();
      ToolPose pose{{0.0, 0.0, 0.001}, axis, random.uniform(-3.0, 3.0)};
      proxy->reset();
      RenderedForce force;
      for (int k = 0; k < 40; ++k) {
        source.contacts_at(pose, contacts);
        proxy->compute({pose, Vec3::Zero()}, contacts, force);
        tool->shortest_depths({pose.position + force.spring / config.stiffness, axis, pose.roll}, all);
        ASSERT_LE(*std::max_element(all.depth.begin(), all.depth.begin() + static_cast<std::ptrdiff_t>(all.size())),
                  1e-9)
            << "step " << k;
        pose.position.z() -= 0.00005;
      }
      EXPECT_GT(force.spring.z(), 0.0);
    }
  }
}

}  // namespace
}  // namespace hapbench::tool_shape_test
