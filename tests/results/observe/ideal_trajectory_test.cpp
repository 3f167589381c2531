#include "results/observe/ideal_trajectory.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/core/random.hpp"

namespace hapbench::ideal_trajectory_test {
namespace {

const BlockWithHole kBlock;
constexpr double kRadius = 0.0005;

TEST(IdealPlace, ExistsWhileTheTipIsOnTheWallAboveTheBottom) {
  const double limit = std::numbers::pi / 3;
  EXPECT_TRUE(ideal_place(kBlock, kRadius, limit - 1e-9));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, limit + 1e-9));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, 0.0));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, -0.5));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, 0.01)) << "would be 100 mm deep";
  EXPECT_TRUE(ideal_place(kBlock, kRadius, 0.3));
}

ToolPose tilted(const Vec3& position, double tilt, double azimuth = 0.0) {
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0};
  return {position, -(std::cos(tilt) * Vec3::UnitZ() + std::sin(tilt) * lean)};
}

TEST(IdealTrajectory, ComparesEachSoManyRows) {
  IdealTrajectoryObserver observer(kBlock, {}, 3);
  for (std::uint64_t step = 0; step < 8; ++step) {
    StepRecord record;
    record.step = step;
    record.tool.pose = tilted({0, 0, -0.001}, step == 3 ? 1.2 : 0.6);
    observer.on_step(record);
    EXPECT_EQ(observer.error().has_value(), step == 0 || step == 6) << step;
  }
  EXPECT_EQ(told(observer, "gentle.rows"), 2.0) << "0 and 6";
  EXPECT_EQ(told(observer, "rows_without_ideal"), 1.0) << "row 3";
}

constexpr double kRounding = 1e-11;  // what the header promises
const Cylinder kTool;

/// Depth at a place on the tool's side: an angle about its axis and a height above its tip.
double depth_at(const ToolPose& pose, double angle, double height) {
  const Vec3 e1 = pose.axis.unitOrthogonal(), e2 = pose.axis.cross(e1);
  const Vec3 side = kTool.radius() * (std::cos(angle) * e1 + std::sin(angle) * e2);
  return -signed_distance(kBlock, pose.position + side - height * pose.axis);
}

/// The deepest place at an angle: of many heights, and then by ternary search round the deepest of them.
double deepest_at(const ToolPose& pose, double angle) {
  constexpr int kHeights = 400;
  constexpr double kApart = 0.006 / kHeights;  // the rest of the tool is in the air
  double best = 0.0;
  for (int h = 0; h < kHeights; ++h) {
    if (depth_at(pose, angle, h * kApart) > depth_at(pose, angle, best)) best = h * kApart;
  }
  double low = std::max(0.0, best - kApart), high = best + kApart;
  while (high - low > 1e-13) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (depth_at(pose, angle, a) > depth_at(pose, angle, b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return std::max(depth_at(pose, angle, best), depth_at(pose, angle, low));
}

/// The deepest place of the tool: of many angles, and then of ever smaller neighbourhoods of the deepest of them.
double searched(const ToolPose& pose) {
  double deepest = 0.0, angle = 0.0;
  const auto look = [&](double from, double apart, int angles) {
    for (int i = 0; i <= angles; ++i) {
      const double depth = deepest_at(pose, from + i * apart);
      if (depth <= deepest) continue;
      deepest = depth;
      angle = from + i * apart;
    }
  };
  constexpr double kApart = std::numbers::pi / 45;
  look(0.0, kApart, 90);
  for (double around = kApart; around > 1e-8; around *= 0.5) look(angle - around, around / 4, 8);
  return deepest;
}

TEST(Interpenetration, EqualsASearchOverTheWholeTool) {
  Random random(9);
  for (int run = 0; run < 40; ++run) {
    const double tilt = random.uniform(0.05, 1.2), azimuth = random.uniform(0, 6.3);
    const ToolPose pose =
        tilted({random.uniform(-7e-4, 7e-4), random.uniform(-7e-4, 7e-4), random.uniform(-4e-3, 3e-4)}, tilt, azimuth);
    EXPECT_NEAR(interpenetration(kBlock, kTool, pose), searched(pose), 2.0 * kRounding) << run;
  }
}

/// Shorter than the hole is deep, and wholly in the wall: the upper end may be the deepest.
TEST(Interpenetration, KnowsTheUpperEndOfAShortTool) {
  const Cylinder tool(kTool.radius(), 0.001);
  for (const double reach : {0.0006, 0.0008}) {
    // Leaning outwards, so that the upper end is further out; far below the top.
    const double tilt = 0.3, s = std::sin(tilt), c = std::cos(tilt);
    const ToolPose pose = tilted({reach, 0.0, -0.003}, tilt);
    EXPECT_NEAR(interpenetration(kBlock, tool, pose), reach + 0.001 * s + 0.0005 * c - 0.001, kRounding);
  }
}

}  // namespace
}  // namespace hapbench::ideal_trajectory_test
