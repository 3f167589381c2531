#include "scenarios/run/scene_distances.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::scene_distances_test {
namespace {

Gap gap_to(const MeshTool& tool, const Vec3& point) {
  return gap_between(tool, ToolPose{}, PointShell({{point, Vec3::UnitZ()}}, 0.0));
}

// Outside of the box of a mesh tool, the distance is a bound: from below for a convex tool, from above for a concave
// tool. It counts as an estimate there, and only there.
TEST(Gap, OfAMeshToolIsAnEstimateOutsideOfItsBox) {
  const Vec3 outside[] = {{0.0, 0.0, -5e-3}, {3e-3, 4e-3, -5e-3}, {-8e-3, 0.2e-3, 3e-3}};
  for (const bool is_convex : {true, false}) {
    const TriangleSoup soup = is_convex ? test::cube(1e-3) : test::scaled(test::cup(12), 1e-3);
    const MeshTool tool(test::grid_of(soup, 5e-5));
    ASSERT_EQ(tool.convex(), is_convex);
    const double error = tool.grid().error_bound();
    const Vec3 in_body(0.85e-3, 0.0, 0.1e-3);  // in the cube, and in the wall of the cup
    const Gap within = gap_to(tool, in_body);
    EXPECT_FALSE(within.is_estimate);
    EXPECT_EQ(within.touching, 1u);
    EXPECT_NEAR(within.distance, test::exact_distance(soup, in_body), error);
    for (const Vec3& point : outside) {
      const Gap beyond = gap_to(tool, point);
      const double exact = test::exact_distance(soup, point);
      EXPECT_TRUE(beyond.is_estimate) << point.transpose();
      EXPECT_EQ(beyond.touching, 0u);
      const double excess = is_convex ? beyond.distance - exact : exact - beyond.distance;
      EXPECT_LE(excess, error) << point.transpose();
    }
  }
}

// A point outside of the box can be nearer to a concave tool than the nearest point in the box, although its upper
// bound is larger. The cup has a radius of 1 mm and is 2 mm high, with walls of 0.3 mm; the point in the box is on its
// axis.
TEST(Gap, OfAConcaveToolIsAnEstimateIfAPointOutsideOfItsBoxCanBeNearer) {
  const MeshTool tool(test::grid_of(test::scaled(test::cup(12), 1e-3), 5e-5));
  const SurfacePoint in_cup{{0.0, 0.0, 1.2e-3}, Vec3::UnitZ()};
  const auto gap = [&](double height) {
    const SurfacePoint above{{0.0, 0.0, height}, Vec3::UnitZ()};
    return gap_between(tool, ToolPose{}, PointShell({in_cup, above}, 0.0));
  };
  EXPECT_FALSE(gap_to(tool, in_cup.position).is_estimate);
  EXPECT_TRUE(gap(2.3e-3).is_estimate) << "0.3 mm above the box";
  EXPECT_FALSE(gap(4e-3).is_estimate) << "2 mm above the box, farther than the point in the cup";
  const Gap of_cylinder = gap_between(Cylinder(1e-3, 0.01, Tip::round), ToolPose{}, PointShell({in_cup}, 0.0));
  EXPECT_FALSE(of_cylinder.is_estimate);
}

}  // namespace
}  // namespace hapbench::scene_distances_test
