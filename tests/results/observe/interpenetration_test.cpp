#include "results/observe/interpenetration.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/random.hpp"

namespace hapbench {
namespace {

constexpr double kRounding = 1e-11;  // what the header promises
const BlockWithHole kBlock;
const Cylinder kTool;

ToolPose upright(double x, double y, double z) {
  return {{x, y, z}, {0, 0, -1}};
}

ToolPose tilted(const Vec3& position, double tilt, double azimuth = 0.0) {
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0};
  return {position, -(std::cos(tilt) * Vec3::UnitZ() + std::sin(tilt) * lean)};
}

TEST(Interpenetration, IsZeroWhereNothingOverlaps) {
  EXPECT_EQ(interpenetration(kBlock, kTool, upright(0, 0, -0.003)), 0.0) << "free in the hole";
  EXPECT_EQ(interpenetration(kBlock, kTool, upright(0.004, 0, 0.001)), 0.0) << "above the top";
  EXPECT_EQ(interpenetration(kBlock, kTool, tilted({0, 0, -0.001}, 0.1)), 0.0) << "leaning in the mouth";
}

TEST(Interpenetration, OfAnUprightToolIsWhatItIsPressedIn) {
  for (const double d : {1e-9, 1e-6, 1e-4, 4e-4}) {
    EXPECT_NEAR(interpenetration(kBlock, kTool, upright(0.004, 0.001, -d)), d, kRounding) << "the top";
    EXPECT_NEAR(interpenetration(kBlock, kTool, upright(0, 0, -0.005 - d)), d, kRounding) << "the bottom";
    for (const double angle : {0.0, 0.3, 2.0, 4.4}) {
      const double reach = 0.0005 + d;
      EXPECT_NEAR(interpenetration(kBlock, kTool, upright(reach * std::cos(angle), reach * std::sin(angle), -0.003)), d,
                  kRounding)
          << "the wall " << angle;
    }
  }
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

/// The deepest of very many points of the tool: never deeper than the answer, and close to it.
TEST(Interpenetration, EqualsADenseSearchOverTheWholeTool) {
  Random random(9);
  for (int run = 0; run < 60; ++run) {
    const double tilt = random.uniform(0.05, 1.2), azimuth = random.uniform(0, 6.3);
    const ToolPose pose =
        tilted({random.uniform(-7e-4, 7e-4), random.uniform(-7e-4, 7e-4), random.uniform(-4e-3, -2e-4)}, tilt, azimuth);
    const double answer = interpenetration(kBlock, kTool, pose);
    const Vec3 e1 = pose.axis.unitOrthogonal(), e2 = pose.axis.cross(e1);
    double deepest = 0.0;
    constexpr int kAngles = 360, kHeights = 400;
    const double along = 0.006;  // the rest of the tool is in the air
    for (int a = 0; a < kAngles; ++a) {
      const double angle = 2.0 * std::numbers::pi * a / kAngles;
      const Vec3 side = kTool.radius() * (std::cos(angle) * e1 + std::sin(angle) * e2);
      for (int h = 0; h < kHeights; ++h) {
        const Vec3 q = pose.position + side - (along * h / kHeights) * pose.axis;
        deepest = std::max(deepest, -signed_distance(kBlock, q));
      }
    }
    EXPECT_LE(deepest, answer + kRounding);
    // The samples lie at most half a height and half an arc from the deepest point.
    const double spacing = 0.5 * std::hypot(along / kHeights, kTool.radius() * 2.0 * std::numbers::pi / kAngles);
    EXPECT_GE(deepest, answer - spacing);
  }
}

TEST(Interpenetration, DoesNotDependOnTheAzimuth) {
  const double expected = interpenetration(kBlock, kTool, tilted({-0.0006, 0, -0.0016}, 0.6));
  EXPECT_GT(expected, 1e-5);
  for (double azimuth = 0.1; azimuth < 6.3; azimuth += 0.37) {
    const Vec3 position{-0.0006 * std::cos(azimuth), -0.0006 * std::sin(azimuth), -0.0016};
    EXPECT_NEAR(interpenetration(kBlock, kTool, tilted(position, 0.6, azimuth)), expected, 2 * kRounding);
  }
}

}  // namespace
}  // namespace hapbench
