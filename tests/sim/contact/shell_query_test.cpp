#include "sim/contact/contact_query.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/scale.hpp"
#include "tests/support/tool_geometry.hpp"

namespace hapbench::shell_query_test {
namespace {

using test::cases;

std::vector<SurfacePoint> at(const std::vector<Vec3>& positions) {
  std::vector<SurfacePoint> points;
  for (const Vec3& position : positions) points.push_back({position, Vec3::UnitZ()});
  return points;
}

const Cylinder kTool;

// Whether a shell of the one point reports it.
bool collides(const Cylinder& tool, const ToolPose& pose, const Vec3& position) {
  const PointShell shell(at({position}), 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  return contacts.size() == 1;
}

class ShellQueryForTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, ShellQueryForTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

TEST_P(ShellQueryForTip, FindsThePointsThatLieInTheToolByDefinition) {
  Random random(1);
  std::size_t inside = 0, outside = 0;
  for (std::size_t i = 0; i < cases(2000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    std::vector<Vec3> positions(100);
    for (Vec3& p : positions) p = test::random_point_near(tool, pose, random);
    const PointShell shell(at(positions), 0.0);
    ShellQuery query(shell, tool);
    ContactBuffer contacts(query.capacity());
    query.contacts_at(pose, contacts);

    std::vector<bool> found(positions.size(), false);
    for (std::size_t k = 0; k < contacts.size(); ++k) found[contacts.index[k]] = true;
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const long double slack = test::slack(tool, pose, positions[k].cast<long double>());
      // Coordinates near 1 m are subtracted and rotated in double: within a few of their roundings of the surface the
      // definition does not decide, and no random point lies there.
      ASSERT_GT(std::abs(slack), 1e-15L);
      ASSERT_EQ(found[k], slack > 0.0L) << "slack " << static_cast<double>(slack);
      ++(slack > 0.0L ? inside : outside);
    }
  }
  // The samples exercise both answers.
  EXPECT_GT(inside, cases(2000) * 20);
  EXPECT_GT(outside, cases(2000) * 20);
}

// Poses along the coordinate axes and dyadic sizes: all coordinates below are exact, so the closed set is exact too.
constexpr double kRadius = 0x5p-13;  // 0.61 mm, a multiple of 5 for the point (3, 4) on the circle
constexpr double kLength = 0x1p-7;
const Vec3 kPosition(0x3p-4, -0x5p-4, 0x1p-4);

struct AxisFrame {
  Vec3 axis, e1, e2;
};
std::vector<AxisFrame> axis_frames() {
  std::vector<AxisFrame> frames;
  for (Eigen::Index k = 0; k < 3; ++k) {
    for (const double sign : {-1.0, 1.0})
      frames.push_back({sign * Vec3::Unit(k), Vec3::Unit((k + 1) % 3), Vec3::Unit((k + 2) % 3)});
  }
  return frames;
}

TEST_P(ShellQueryForTip, PointsExactlyOnTheSurfaceCollide) {
  const Cylinder tool{kRadius, kLength, GetParam()};
  for (const AxisFrame& f : axis_frames()) {
    const ToolPose pose{kPosition, f.axis};
    const auto expect_hit = [&](double s, double a, double b) {
      EXPECT_TRUE(collides(tool, pose, kPosition + s * f.axis + a * f.e1 + b * f.e2)) << s << ' ' << a << ' ' << b;
    };
    for (const double s : {0.0, -kLength / 2, -kLength}) {
      expect_hit(s, kRadius, 0.0);
      expect_hit(s, 0.0, -kRadius);
      expect_hit(s, 0.6 * kRadius, 0.8 * kRadius);  // 3 and 4 units of 2^-13: exact
      expect_hit(s, 0.0, 0.0);
    }
    if (GetParam() == Tip::round) {
      expect_hit(kRadius, 0.0, 0.0);
      expect_hit(0.6 * kRadius, 0.8 * kRadius, 0.0);
      expect_hit(0.8 * kRadius, 0.0, -0.6 * kRadius);
    }
  }
}

TEST_P(ShellQueryForTip, PointsJustOutsideTheSurfaceDoNotCollide) {
  const Cylinder tool{kRadius, kLength, GetParam()};
  // One unit in the last place of the coordinates, which are below 1/2; the radius is far above it.
  const double out = 0x1p-53;
  for (const AxisFrame& f : axis_frames()) {
    const ToolPose pose{kPosition, f.axis};
    const auto expect_miss = [&](double s, double a, double b) {
      EXPECT_FALSE(collides(tool, pose, kPosition + s * f.axis + a * f.e1 + b * f.e2)) << s << ' ' << a << ' ' << b;
    };
    expect_miss(-kLength - out, 0.0, 0.0);
    expect_miss(-kLength / 2, kRadius + out, 0.0);
    expect_miss(-kLength / 2, 0.0, -kRadius - out);
    if (GetParam() == Tip::flat) {
      expect_miss(out, 0.0, 0.0);
    } else {
      expect_miss(kRadius + out, 0.0, 0.0);
      expect_miss(0.6 * kRadius + out, 0.8 * kRadius + out, 0.0);
    }
  }
}

TEST_P(ShellQueryForTip, ReportsPointsInAscendingOrderAsTheShellHasThem) {
  Random random(2);
  const Cylinder tool = test::random_tool(random, GetParam());
  const ToolPose pose = test::random_pose(random);
  std::vector<SurfacePoint> points(1000);
  for (SurfacePoint& p : points) p = {test::random_point_near(tool, pose, random), random.direction()};
  const PointShell shell(points, 0.0);
  ShellQuery query(shell, tool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at(pose, contacts);
  ASSERT_GT(contacts.size(), 100u);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    ASSERT_TRUE(k == 0 || contacts.index[k - 1] < contacts.index[k]);
    EXPECT_EQ(contacts.point(k), points[contacts.index[k]].position);
    EXPECT_EQ(contacts.normal(k), points[contacts.index[k]].normal);
  }
}

TEST(ShellQuery, ReplacesWhatTheBufferHeld) {
  const PointShell shell(at({Vec3::Zero()}), 0.0);
  ShellQuery query(shell, kTool);
  ContactBuffer contacts(query.capacity());
  query.contacts_at({}, contacts);
  EXPECT_EQ(contacts.size(), 1u);
  query.contacts_at({}, contacts);
  EXPECT_EQ(contacts.size(), 1u);
  query.contacts_at({{1, 0, 0}, {0, 0, -1}}, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(ShellQuery, ANonFinitePoseTouchesNothing) {
  const PointShell shell(at({Vec3::Zero()}), 0.0);
  ShellQuery query(shell, kTool);
  ContactBuffer contacts(query.capacity());
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    query.contacts_at({{x, 0, 0}, {0, 0, -1}}, contacts);
    EXPECT_TRUE(contacts.empty());
  }
}

TEST(ShellQuery, CountsQueriesAndPointsTestedWithoutPadding) {
  const PointShell shell(at(std::vector<Vec3>(13, Vec3::Zero())), 0.0);
  ShellQuery query(shell, kTool);
  ContactBuffer contacts(query.capacity());
  for (int i = 0; i < 3; ++i) query.contacts_at({}, contacts);
  EXPECT_EQ(query.work().queries, 3u);
  EXPECT_EQ(query.work().points_tested, 39u);
  query.reset();
  EXPECT_EQ(query.work().queries, 0u);
  EXPECT_EQ(query.work().points_tested, 0u);
}

TEST(ShellQuery, ReturnsAtMostEveryPoint) {
  const PointShell shell(at({Vec3::Zero()}), 0.0);
  EXPECT_EQ(ShellQuery(shell, kTool).capacity(), 1u);
}

}  // namespace
}  // namespace hapbench::shell_query_test
