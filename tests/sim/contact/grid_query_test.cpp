#include "sim/contact/grid_query.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

/// The search without a list must answer exactly as brute force does: same points, same order, same bits.
namespace hapbench {
namespace {

using test::cases;
using test::next_pose;
using test::random_shell;
using Pair = test::SearchPair<GridQuery>;

TEST(GridQuery, FindsWhatBruteForceFindsAtAMillionPoses) {
  Random random(7);
  std::uint64_t contacts = 0;
  for (std::size_t s = 0; s < cases(2000); ++s) {
    const double size = std::pow(10.0, random.uniform(-4.0, 0.0));
    const Cylinder tool{size * random.uniform(0.02, 0.5), size * random.uniform(0.05, 3.0),
                        random.below(2) == 0 ? Tip::flat : Tip::round};
    Pair pair(random_shell(random, size), random.below(2) == 0 ? 0.0 : size * random.uniform(0.01, 1.0), tool);
    ToolPose pose{Vec3::Zero(), random.direction()};
    for (int k = 0; k < 500; ++k) {
      pose = next_pose(pose, random, size, 0.2 * tool.radius());
      ASSERT_TRUE(pair.agree_at(pose)) << "shell " << s << ", pose " << k;
    }
    contacts += pair.contacts();
  }
  // The walks touch something.
  EXPECT_GT(contacts, cases(2000) * 500);
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
  Random random(13);
  std::uint64_t contacts = 0;
  const std::size_t shells = cases(2000);
  for (std::size_t s = 0; s < shells; ++s) {
    const double size = std::pow(10.0, random.uniform(-4.0, 0.0));
    const test::DefinedTool tool = GetParam().make(random, 0.5 * size);
    Pair pair(random_shell(random, size), random.below(2) == 0 ? 0.0 : size * random.uniform(0.01, 1.0), tool.shape);
    ToolPose pose{Vec3::Zero(), random.direction()};
    for (int k = 0; k < 500; ++k) {
      pose = next_pose(pose, random, size, 0.2 * tool.shape->half_width());
      ASSERT_TRUE(pair.agree_at(pose)) << "shell " << s << ", pose " << k;
    }
    contacts += pair.contacts();
  }
  EXPECT_GT(contacts, shells * 250);
}

}  // namespace
}  // namespace hapbench
