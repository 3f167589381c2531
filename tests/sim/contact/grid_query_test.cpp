#include "sim/contact/neighbour_list_query.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

/// The search without a list must answer exactly as brute force does: same points, same order, same bits.
namespace hapbench::grid_query_test {
namespace {

using test::cases;
using test::next_pose;
using Pair = test::SearchPair<GridQuery>;

TEST(GridQuery, FindsWhatBruteForceFindsAtAMillionPoses) {
  test::WalkTotals totals;
  test::expect_agreement_at_a_million_poses<GridQuery>(Random(7), test::random_drill, totals);
  // The walks touch something.
  EXPECT_GT(totals.contacts, totals.poses);
}

// Points that lie exactly on the tool's surface are in the box, whatever the rounding of either.
TEST(GridQuery, AgreesOnTheAnalyticShells) {
  Random random(8);
  const Cylinder round{0.0005, 0.005, Tip::round}, flat{0.0005, 0.01, Tip::flat};
  Pair hole(surface_points(Hole2d{}), 0.0001, round);
  Pair plane(surface_points(Plane{0.004, 0.0001}), 0.0001, flat);
  ToolPose pose{{0, -0.004, 0}, {0, -1, 0}}, pose_3d{{0, 0, 0}, {0, 0, -1}};
  for (std::size_t k = 0; k < cases(20'000); ++k) {
    ASSERT_TRUE(hole.agree_at(pose));
    ASSERT_TRUE(plane.agree_at(pose_3d));
    pose = next_pose(pose, random, 0.004, 0.00005);
    pose_3d = next_pose(pose_3d, random, 0.002, 0.00005);
  }
  EXPECT_GT(hole.contacts() + plane.contacts(), 1000u);
}

TEST(GridQuery, TestsTheCellsAroundTheToolOnly) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  const std::vector<SurfacePoint> points = surface_points(Plane{0.02, 0.0001});
  Pair pair(points, 0.0001, tool);
  ASSERT_TRUE(pair.agree_at({Vec3::Zero(), {0, 0, -1}}));
  EXPECT_EQ(pair.work().queries, 1u);
  EXPECT_GE(pair.work().points_tested, pair.contacts());
  // Cells of 2.5 spacings: the box of 1 mm is at most 1 mm and two cells wide.
  EXPECT_LE(pair.work().points_tested, 16u * 16u);
  pair.reset();
  EXPECT_EQ(pair.work().points_tested, 0u);
}

TEST(GridQuery, SurvivesAnEmptyShellAndPosesThatAreNotFinite) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  Pair empty({}, 0.0001, tool);
  EXPECT_TRUE(empty.agree_at({Vec3::Zero(), {0, 0, -1}}));
  Pair pair(surface_points(Plane{0.004, 0.0001}), 0.0001, tool);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e300}) {
    EXPECT_TRUE(pair.agree_at({{bad, 0, 0}, {0, 0, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, 0}, {0, bad, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, 0}, {0, 0, -1}}));
  }
}

class GridQueryOfTool : public testing::TestWithParam<test::ToolKind> {};
INSTANTIATE_TEST_SUITE_P(EveryKind, GridQueryOfTool,
                         testing::ValuesIn(test::tool_kinds().begin(), test::tool_kinds().end()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(GridQueryOfTool, FindsWhatBruteForceFindsAtAMillionPoses) {
  const auto make_tool = [](Random& random, double size) { return GetParam().make(random, 0.5 * size).shape; };
  test::WalkTotals totals;
  test::expect_agreement_at_a_million_poses<GridQuery>(Random(13), make_tool, totals);
  EXPECT_GT(totals.contacts, totals.poses / 2);
}

}  // namespace
}  // namespace hapbench::grid_query_test
