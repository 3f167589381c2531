#include "algorithms/depth/surface_normal.hpp"

#include <gtest/gtest.h>

#include "algorithms/depth/shortest_distance.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::surface_normal_test {
namespace {

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
    make_surface_normal()->evaluate(tool, pose, contacts);
    make_shortest_distance()->evaluate(tool, pose, shortest);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.depth[i], shortest.depth[i]);
      EXPECT_EQ(contacts.gradient(i), Vec3(-contacts.normal(i)));
    }
  }
}

TEST(SurfaceNormal, DepthOnAFlatSaturatesAtTheToolsRadius) {
  // Thesis C.1: however far the tool is pressed through a plane, a point on its axis is r deep at most.
  const Cylinder tool;
  for (const double pressed : {0.0001, 0.0004, 0.002, 0.005}) {
    ContactBuffer contacts(1);
    contacts.push(0, Vec3::Zero(), Vec3::UnitZ());
    make_surface_normal()->evaluate(tool, {{0, 0, -pressed}, {0, 0, -1}}, contacts);
    EXPECT_EQ(contacts.depth[0], std::min(pressed, tool.radius()));
  }
}

}  // namespace
}  // namespace hapbench::surface_normal_test
