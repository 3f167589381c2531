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

TEST(IdealPlace, ContactWithTheWallEndsAtSixtyDegrees) {
  const double limit = std::numbers::pi / 3;
  EXPECT_TRUE(ideal_place(kBlock, kRadius, limit - 1e-9));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, limit + 1e-9));
}

TEST(IdealPlace, ExistsOnlyWhileTheTipIsAboveTheBottom) {
  EXPECT_FALSE(ideal_place(kBlock, kRadius, 0.0));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, -0.5));
  EXPECT_FALSE(ideal_place(kBlock, kRadius, 0.01)) << "would be 100 mm deep";
  EXPECT_TRUE(ideal_place(kBlock, kRadius, 0.3));
  BlockWithHole shallow;
  shallow.hole_depth = 0.001;
  EXPECT_FALSE(ideal_place(shallow, kRadius, 0.3));
}

/// The geometry behind the formula: the lower edge of the tip on the wall, the shaft through the rim opposite.
TEST(IdealPlace, TipEdgeIsOnTheWallAndTheRimOnTheShaft) {
  for (double tilt = 0.21; tilt < 1.04; tilt += 0.03) {
    const auto place = ideal_place(kBlock, kRadius, tilt);
    ASSERT_TRUE(place);
    const Eigen::Vector2d tip(place->lateral, place->height);
    const Eigen::Vector2d up_the_shaft(std::sin(tilt), std::cos(tilt));
    const Eigen::Vector2d across(-std::cos(tilt), std::sin(tilt));  // towards the wall that the tip touches
    const Eigen::Vector2d edge = tip + kRadius * across;
    EXPECT_NEAR(edge.x(), -0.001, 1e-18);
    const Eigen::Vector2d rim = Eigen::Vector2d(0.001, 0.0) - tip;
    EXPECT_NEAR(rim.dot(-across), kRadius, 1e-17) << "the rim is a radius from the axis";
    EXPECT_GT(rim.dot(up_the_shaft), 0.0);
  }
}

StepRecord row(const Vec3& position, double tilt, double azimuth, double push) {
  StepRecord record;
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0};
  record.tool.pose = {position, -(std::cos(tilt) * Vec3::UnitZ() + std::sin(tilt) * lean)};
  record.hand_force = {0, 0, -push};
  return record;
}

TEST(IdealTrajectory, ErrorsAreActualMinusIdealInThePlaneOfTheTilt) {
  const double tilt = 0.6, azimuth = 2.0;
  const TipPlace ideal = *ideal_place(kBlock, kRadius, tilt);
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0}, aside{-lean.y(), lean.x(), 0.0};
  IdealTrajectoryObserver observer(kBlock);
  const Vec3 place = (ideal.lateral + 2e-5) * lean + 1e-4 * aside + (ideal.height - 3e-5) * Vec3::UnitZ();
  observer.on_step(row(place, tilt, azimuth, 1.0));
  ASSERT_TRUE(observer.error());
  EXPECT_NEAR(observer.error()->tilt, tilt, 1e-15);
  EXPECT_EQ(told(observer, "gentle.rows"), 1.0);
  EXPECT_NEAR(told(observer, "gentle.lateral_error_mean_m").value(), 2e-5, 1e-17);
  EXPECT_NEAR(told(observer, "gentle.height_error_mean_m").value(), -3e-5, 1e-17) << "sunk in";
  EXPECT_NEAR(told(observer, "gentle.height_error_rms_m").value(), 3e-5, 1e-17);
  EXPECT_GT(told(observer, "gentle.interpenetration_max_m"), 0.0);
}

TEST(IdealTrajectory, SplitsAtTwoNewtonsOfTheHand) {
  IdealTrajectoryObserver observer(kBlock);
  for (const double push : {0.0, 1.0, 1.999, 2.0, 5.0}) observer.on_step(row({0, 0, -0.001}, 0.6, 0.0, push));
  EXPECT_EQ(told(observer, "gentle.rows"), 3.0);
  EXPECT_EQ(told(observer, "firm.rows"), 2.0);
}

TEST(IdealTrajectory, ComparesEachSoManyRows) {
  IdealTrajectoryObserver observer(kBlock, {}, 3);
  for (std::uint64_t step = 0; step < 8; ++step) {
    StepRecord r = row({0, 0, -0.001}, step == 3 ? 1.2 : 0.6, 0.0, static_cast<double>(step));
    r.step = step;
    observer.on_step(r);
    EXPECT_EQ(observer.error().has_value(), step == 0 || step == 6) << step;
  }
  EXPECT_EQ(told(observer, "gentle.rows"), 1.0) << "row 0";
  EXPECT_EQ(told(observer, "firm.rows"), 1.0) << "row 6";
  EXPECT_EQ(told(observer, "rows_without_ideal"), 1.0) << "row 3";
}

TEST(IdealTrajectory, LeavesOutTiltsWithoutContact) {
  IdealTrajectoryObserver observer(kBlock);
  observer.on_step(row({0, 0, -0.001}, 1.2, 0.0, 1.0));
  observer.on_step(row({0, 0, -0.001}, 0.0, 0.0, 1.0));
  EXPECT_FALSE(observer.error());
  EXPECT_EQ(told(observer, "rows_without_ideal"), 2.0);
  EXPECT_EQ(told(observer, "gentle.rows"), 0.0);
}

TEST(IdealTrajectory, MeansAndExtremesAreOverTheRows) {
  const double tilt = 0.5;
  const TipPlace ideal = *ideal_place(kBlock, kRadius, tilt);
  IdealTrajectoryObserver observer(kBlock);
  for (const double error : {-3e-5, 1e-5, 4e-5, -2e-5}) {
    observer.on_step(row({ideal.lateral, 0, ideal.height + error}, tilt, 0.0, 3.0));
  }
  const auto error = [&](const char* name) { return told(observer, std::string("firm.") + name).value(); };
  EXPECT_NEAR(error("height_error_mean_m"), 0.0, 1e-17);
  EXPECT_NEAR(error("height_error_rms_m"), 1e-5 * std::sqrt((9 + 1 + 16 + 4) / 4.0), 1e-17);
  EXPECT_NEAR(error("height_error_min_m"), -3e-5, 1e-17);
  EXPECT_NEAR(error("height_error_max_m"), 4e-5, 1e-17);
  EXPECT_GE(error("interpenetration_max_m"), error("interpenetration_mean_m"));
}

constexpr double kRounding = 1e-11;  // what the header promises
const Cylinder kTool;

ToolPose tilted(const Vec3& position, double tilt, double azimuth = 0.0) {
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0};
  return {position, -(std::cos(tilt) * Vec3::UnitZ() + std::sin(tilt) * lean)};
}

/// On the ideal trajectory the tool touches wall and rim without overlapping; pushed down by a little it overlaps by as
/// much as the formula of the trajectory's two contacts says.
TEST(Interpenetration, OnTheIdealTrajectoryIsZeroAndBelowItGrows) {
  const double R = 0.001, r = 0.0005;
  for (const double tilt : {0.35, 0.6, 0.8, 1.0}) {
    const double c = std::cos(tilt), s = std::sin(tilt);
    const Vec3 ideal{-R + r * c, 0.0, (r * (1 + c * c) - 2 * R * c) / s};
    EXPECT_LE(interpenetration(kBlock, kTool, tilted(ideal, tilt)), 1e-10);
    double last = 0.0;
    for (const double d : {1e-6, 1e-5, 1e-4}) {
      // Straight down, the shaft moves d sin(tilt) into the rim; the depth is measured at 45 degrees.
      const double depth = interpenetration(kBlock, kTool, tilted(ideal - d * Vec3::UnitZ(), tilt));
      EXPECT_GT(depth, last);
      EXPECT_NEAR(depth, d * s / (s + c), 0.05 * d) << "first order, the curvature of rim and shaft left out";
      last = depth;
    }
  }
}

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

/// The tip's edge just below the rim: what is deepest is the edge's point on the cone, a kink of the depth.
TEST(Interpenetration, OfATipOnTheRimIsThatOfItsEdge) {
  for (const double d : {1e-7, 1e-5, 1e-4}) {
    for (const double tilt : {0.05, 0.3, 0.7}) {
      const double s = std::sin(tilt), c = std::cos(tilt);
      // The lowest point of the tip's edge, d below the top and outside the rim.
      const Vec3 low{0.001 + d, 0.0, -d}, place = low - kTool.radius() * Vec3(c, 0.0, -s);
      EXPECT_NEAR(interpenetration(kBlock, kTool, tilted(place, tilt)), d, kRounding) << tilt;
    }
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
