#include "sim/contact/neighbour_list_query.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

/// The contact search of a run must answer exactly as brute force does, whatever the tool did before: same points, same
/// order, same bits.
namespace hapbench::neighbour_list_query_test {
namespace {

using test::cases;

using Pair = test::SearchPair<NeighbourListQuery>;
using test::next_pose;

TEST(NeighbourListQuery, FindsWhatBruteForceFindsAtAMillionPoses) {
  test::WalkTotals totals;
  test::expect_agreement_at_a_million_poses<NeighbourListQuery>(Random(3), test::random_drill, totals);
  // The walks touch something, and the lists are used more than once.
  EXPECT_GT(totals.contacts, totals.poses);
  EXPECT_LT(totals.lists_rebuilt, totals.poses / 2);
}

TEST(NeighbourListQuery, HoldsToItsInequalityWhenTheToolTurnsAboutItsTip) {
  // The bottom end, 10 mm from the tip, sweeps furthest: a list that ignored rotation would miss these points.
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  std::vector<SurfacePoint> arc;
  for (int k = 0; k < 360; ++k) {
    const double a = k * std::numbers::pi / 180.0;
    arc.push_back({{0.0098 * std::sin(a), 0.0, 0.0098 * std::cos(a)}, {0, 0, 1}});
  }
  Pair pair(arc, 0.0001, tool);
  for (double tilt = 0.0; tilt < 6.0; tilt += 0.001) {
    ASSERT_TRUE(pair.agree_at({Vec3::Zero(), {-std::sin(tilt), 0.0, -std::cos(tilt)}})) << tilt;
  }
  EXPECT_GT(pair.contacts(), 6000u);
}

TEST(NeighbourListQuery, AgreesOnTheAnalyticShells) {
  Random random(5);
  const Cylinder round{0.0005, 0.005, Tip::round}, flat{0.0005, 0.01, Tip::flat};
  Pair hole(surface_points(Hole2d{}), 0.0001, round);
  Pair plane(surface_points(Plane{0.004, 0.0001}), 0.0001, flat);
  Pair slot(surface_points(Slot{0.001, 0.003, 0.004, 0.0001}), 0.0001, flat);
  ToolPose pose{{0, -0.004, 0}, {0, -1, 0}}, pose_3d{{0, 0, 0}, {0, 0, -1}};
  for (std::size_t k = 0; k < cases(20'000); ++k) {
    pose = next_pose(pose, random, 0.004, 0.00005);
    pose_3d = next_pose(pose_3d, random, 0.002, 0.00005);
    ASSERT_TRUE(hole.agree_at(pose));
    ASSERT_TRUE(plane.agree_at(pose_3d));
    ASSERT_TRUE(slot.agree_at(pose_3d));
  }
  EXPECT_GT(hole.contacts() + plane.contacts() + slot.contacts(), 1000u);
}

TEST(NeighbourListQuery, TestsNothingInFreeAir) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  Pair pair(surface_points(Plane{0.004, 0.0001}), 0.0001, tool);
  ASSERT_TRUE(pair.agree_at({{0, 0, 0.05}, {0, 0, -1}}));
  const std::uint64_t tested = pair.work().points_tested;
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(pair.agree_at({{1e-6 * k, 0, 0.05 - 1e-6 * k}, {0, 0, -1}}));
  EXPECT_EQ(pair.work().points_tested, tested);
  EXPECT_EQ(pair.work().skipped, 1000u);
}

TEST(NeighbourListQuery, AfterResetDoesTheSameWorkAgain) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  Pair pair(surface_points(Plane{0.004, 0.0001}), 0.0001, tool);
  const auto walk = [&pair] {
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(pair.agree_at({{1e-5 * k, 0, 0.0003 - 1e-5 * k}, {0, 0, -1}}));
    return pair.work();
  };
  const SearchWork first = walk();
  pair.reset();
  const SearchWork second = walk();
  EXPECT_EQ(first.points_tested, second.points_tested);
  EXPECT_EQ(first.lists_rebuilt, second.lists_rebuilt);
  EXPECT_GT(first.lists_rebuilt, 0u);
}

TEST(NeighbourListQuery, SurvivesAnEmptyShellAndPosesThatAreNotFinite) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  Pair empty({}, 0.0001, tool);
  EXPECT_TRUE(empty.agree_at({Vec3::Zero(), {0, 0, -1}}));
  Pair pair(surface_points(Plane{0.004, 0.0001}), 0.0001, tool);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e300}) {
    EXPECT_TRUE(pair.agree_at({{bad, 0, 0}, {0, 0, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, bad}, {0, 0, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, 0}, {0, 0, -1}}));
  }
}

class NeighbourListQueryOfTool : public testing::TestWithParam<test::ToolKind> {};
INSTANTIATE_TEST_SUITE_P(EveryKind, NeighbourListQueryOfTool,
                         testing::ValuesIn(test::tool_kinds().begin(), test::tool_kinds().end()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(NeighbourListQueryOfTool, FindsWhatBruteForceFindsAtAMillionPoses) {
  const auto make_tool = [](Random& random, double size) { return GetParam().make(random, 0.5 * size).shape; };
  test::WalkTotals totals;
  test::expect_agreement_at_a_million_poses<NeighbourListQuery>(Random(13), make_tool, totals);
  EXPECT_GT(totals.contacts, totals.poses / 2);
}

}  // namespace
}  // namespace hapbench::neighbour_list_query_test
