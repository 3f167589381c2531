#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "sim/contact/neighbour_list_query.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::searches_test {
namespace {

using test::cases;
using test::next_pose;
using test::SearchPair;

constexpr double kInf = std::numeric_limits<double>::infinity(), kNaN = std::numeric_limits<double>::quiet_NaN();
const Cylinder kDrill(0.0005, 0.01, Tip::flat);

/// Checks that the search gives exactly the result of brute force, whatever the tool did before: same points, same
/// order, same bits.
TEST(NeighbourListQuery, FindsWhatBruteForceFindsAtPosesOfEveryKindOfTool) {
  for (const test::ToolKind& kind : test::tool_kinds()) {
    SCOPED_TRACE(kind.name);
    const auto make_tool = [&](Random& random, double size) { return kind.make(random, 0.5 * size).shape; };
    test::WalkTotals totals;
    test::expect_agreement_with_brute_force(Random(13), make_tool, totals);
    // Check that the tools touch points on their random walks, and that neighbour lists are used more than once.
    EXPECT_GT(totals.contacts, totals.poses / 2);
    EXPECT_LT(totals.lists_rebuilt, totals.poses / 2);
  }
}

TEST(NeighbourListQuery, SurvivesAnEmptyShellAndPosesThatAreNotFinite) {
  SearchPair empty({}, 0.0001, kDrill), pair(surface_points(Plane{0.004, 0.0001}), 0.0001, kDrill);
  EXPECT_TRUE(empty.agree_at({Vec3::Zero(), {0, 0, -1}}));
  for (const double bad : {kNaN, kInf, -kInf, 1e300}) {
    const std::uint64_t before = pair.contacts();
    EXPECT_TRUE(pair.agree_at({{bad, 0, 0}, {0, 0, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, bad}, {0, 0, -1}}));
    EXPECT_EQ(pair.contacts(), before);
    EXPECT_TRUE(pair.agree_at({{0, 0, 0}, {0, bad, -1}}));
    EXPECT_TRUE(pair.agree_at({{0, 0, 0}, {0, 0, -1}}));
  }
}

TEST(NeighbourListQuery, HoldsToItsInequalityWhenTheToolTurnsAboutItsTip) {
  // Points on the arc on which the end opposite to the tip moves, 10 mm away from the tip. A rotation about the tip
  // moves this end farthest. A neighbour list that ignored rotation would miss these points.
  std::vector<SurfacePoint> arc;
  for (int k = 0; k < 360; ++k) {
    const double a = k * std::numbers::pi / 180.0;
    arc.push_back({{0.0098 * std::sin(a), 0.0, 0.0098 * std::cos(a)}, {0, 0, 1}});
  }
  SearchPair pair(arc, 0.0001, kDrill);
  for (double tilt = 0.0; tilt < 6.0; tilt += 0.001) {
    ASSERT_TRUE(pair.agree_at({Vec3::Zero(), {-std::sin(tilt), 0.0, -std::cos(tilt)}})) << tilt;
  }
  EXPECT_GT(pair.contacts(), 6000u);
}

TEST(NeighbourListQuery, TestsNothingInFreeAir) {
  SearchPair pair(surface_points(Plane{0.004, 0.0001}), 0.0001, kDrill);
  ASSERT_TRUE(pair.agree_at({{0, 0, 0.05}, {0, 0, -1}}));
  const std::uint64_t tested = pair.work().points_tested;
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(pair.agree_at({{1e-6 * k, 0, 0.05 - 1e-6 * k}, {0, 0, -1}}));
  EXPECT_EQ(pair.work().points_tested, tested);
  EXPECT_EQ(pair.work().skipped, 1000u);
}

std::vector<SurfacePoint> at(const std::vector<Vec3>& positions) {
  std::vector<SurfacePoint> points;
  for (const Vec3& position : positions) points.push_back({position, Vec3::UnitZ()});
  return points;
}

/// Returns true if a search over a shell whose only point is at `position` reports this point.
bool collides(const Cylinder& tool, const ToolPose& pose, const Vec3& position) {
  const PointShell shell(at({position}), 0.0);
  const auto query = make_contact_query(shell, tool, Skips::off);
  ContactBuffer contacts(query->capacity());
  query->contacts_at(pose, contacts);
  return contacts.size() == 1;
}

class ShellQueryForTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, ShellQueryForTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

// With poses along the coordinate axes, and lengths that are small multiples of a power of two, all coordinates below
// are exact. It is therefore exactly known which points are in the tool, including its surface.
constexpr double kRadius = 0x5p-13;  // 0.61 mm, a multiple of 5 for the point (3, 4) on the circle
constexpr double kLength = 0x1p-7;
// One unit in the last place of coordinates below 1/2; the radius is far larger than this unit.
constexpr double kOut = 0x1p-53;
const Vec3 kPosition(0x3p-4, -0x5p-4, 0x1p-4);

/// Returns points (s, a, b) on the surface of the cylinder and on its axis: s along the axis, a and b perpendicular to
/// it [m].
std::vector<Vec3> on_cylinder() {
  std::vector<Vec3> points;
  for (const double s : {0.0, -kLength / 2, -kLength}) {
    // 0.6 and 0.8 radii are 3 and 4 units of 2^-13, which are exact.
    for (const auto& [a, b] : {std::pair(1.0, 0.0), {0.0, -1.0}, {0.6, 0.8}, {0.0, 0.0}})
      points.push_back({s, a * kRadius, b * kRadius});
  }
  return points;
}
const std::vector<Vec3> kOnRound = {
    {kRadius, 0, 0}, {0.6 * kRadius, 0.8 * kRadius, 0}, {0.8 * kRadius, 0, -0.6 * kRadius}};
const std::vector<Vec3> kOffBoth = {
    {-kLength - kOut, 0, 0}, {-kLength / 2, kRadius + kOut, 0}, {-kLength / 2, 0, -kRadius - kOut}};
const std::vector<Vec3> kOffFlat = {{kOut, 0, 0}};
const std::vector<Vec3> kOffRound = {{kRadius + kOut, 0, 0}, {0.6 * kRadius + kOut, 0.8 * kRadius + kOut, 0}};

TEST_P(ShellQueryForTip, FindsPointsExactlyOnTheSurfaceAndNoneJustOutside) {
  const Cylinder tool{kRadius, kLength, GetParam()};
  for (Eigen::Index k = 0; k < 6; ++k) {
    const Vec3 axis = (k < 3 ? -1.0 : 1.0) * Vec3::Unit(k % 3), e1 = Vec3::Unit((k + 1) % 3),
               e2 = Vec3::Unit((k + 2) % 3);
    const auto expect = [&](const std::vector<Vec3>& points, bool hit) {
      for (const Vec3& p : points) {
        const Vec3 point = kPosition + p[0] * axis + p[1] * e1 + p[2] * e2;
        EXPECT_EQ(collides(tool, {kPosition, axis}, point), hit) << k << ": " << p.transpose();
      }
    };
    expect(on_cylinder(), true);
    expect(kOffBoth, false);
    expect(GetParam() == Tip::round ? kOnRound : std::vector<Vec3>{}, true);
    expect(GetParam() == Tip::round ? kOffRound : kOffFlat, false);
  }
}

std::size_t marked_near(const PointShell& shell, const ToolShape& tool, const ToolPose& pose, double margin) {
  const PackRange all{0, shell.padded_size() / simd::lanes};
  std::vector<std::uint8_t> marks(all.last);
  tool.mark_near(pose, margin, {shell.x(), shell.y(), shell.z()}, {&all, 1}, marks.data());
  return std::accumulate(marks.begin(), marks.end(), std::size_t{0}, [](std::size_t n, std::uint8_t mark) {
    return n + static_cast<std::size_t>(std::popcount(mark));
  });
}

/// Returns the largest number of points within a margin of the tool over some poses, divided by the bound of this
/// number.
double worst_part_of_bound(const ToolShape& tool, double size, Random& random) {
  const double margin = random.uniform(0.0, 0.3) * tool.half_width();
  const PointShell shell(test::random_shell(random, size), 0.0);
  const std::size_t bound = max_points_in(shell, tool.cover(margin));
  EXPECT_LE(bound, shell.size());
  ToolPose pose{Vec3::Zero(), random.direction()};
  std::size_t worst = 0;
  for (int k = 0; k < 50; ++k) {
    pose = next_pose(pose, random, size, 0.2 * tool.half_width());
    worst = std::max(worst, marked_near(shell, tool, pose, margin));
  }
  EXPECT_LE(worst, bound);
  return static_cast<double>(worst) / static_cast<double>(std::max<std::size_t>(1, bound));
}

TEST(MostPoints, BoundWhatAnyToolHasNearItAnywhere) {
  Random random(5);
  double tightest = 0.0;
  for (std::size_t i = 0; i < cases(20000); ++i) {
    const double size = std::pow(10.0, random.uniform(-4.0, 0.0));
    const Tip tip = random.below(2) == 0 ? Tip::flat : Tip::round;
    const Cylinder drill{size * random.uniform(0.01, 0.2), size * random.uniform(0.02, 3.0), tip};
    tightest = std::max(tightest, worst_part_of_bound(drill, size, random));
  }
  // Check that points came near the tools on some random walks. A sanitized build does only a thirtieth of the walks,
  // so this is not required there.
  EXPECT_TRUE(tightest > 0.1 || HAPBENCH_TEST_SANITIZED != 0) << tightest;
}

}  // namespace
}  // namespace hapbench::searches_test
