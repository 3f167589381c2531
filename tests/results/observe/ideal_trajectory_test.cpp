#include "results/observe/ideal_trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
  IdealTrajectoryObserver observer(kBlock, {});
  const Vec3 place = (ideal.lateral + 2e-5) * lean + 1e-4 * aside + (ideal.height - 3e-5) * Vec3::UnitZ();
  observer.on_step(row(place, tilt, azimuth, 1.0));
  ASSERT_TRUE(observer.error());
  EXPECT_NEAR(observer.error()->tilt, tilt, 1e-15);
  const TrajectoryErrors e = observer.metrics().gentle;
  EXPECT_EQ(e.rows, 1u);
  EXPECT_NEAR(e.lateral_mean, 2e-5, 1e-17);
  EXPECT_NEAR(e.height_mean, -3e-5, 1e-17) << "sunk in";
  EXPECT_NEAR(e.height_rms, 3e-5, 1e-17);
  EXPECT_GT(e.interpenetration_max, 0.0);
}

TEST(IdealTrajectory, SplitsAtTwoNewtonsOfTheHand) {
  IdealTrajectoryObserver observer(kBlock, {});
  for (const double push : {0.0, 1.0, 1.999, 2.0, 5.0}) observer.on_step(row({0, 0, -0.001}, 0.6, 0.0, push));
  EXPECT_EQ(observer.metrics().gentle.rows, 3u);
  EXPECT_EQ(observer.metrics().firm.rows, 2u);
}

TEST(IdealTrajectory, ComparesEachSoManyRows) {
  IdealTrajectoryObserver observer(kBlock, {}, 3);
  for (std::uint64_t step = 0; step < 8; ++step) {
    StepRecord r = row({0, 0, -0.001}, step == 3 ? 1.2 : 0.6, 0.0, static_cast<double>(step));
    r.step = step;
    observer.on_step(r);
    EXPECT_EQ(observer.error().has_value(), step == 0 || step == 6) << step;
  }
  EXPECT_EQ(observer.metrics().gentle.rows, 1u) << "row 0";
  EXPECT_EQ(observer.metrics().firm.rows, 1u) << "row 6";
  EXPECT_EQ(observer.metrics().rows_without_ideal, 1u) << "row 3";
}

TEST(IdealTrajectory, LeavesOutTiltsWithoutContact) {
  IdealTrajectoryObserver observer(kBlock, {});
  observer.on_step(row({0, 0, -0.001}, 1.2, 0.0, 1.0));
  observer.on_step(row({0, 0, -0.001}, 0.0, 0.0, 1.0));
  EXPECT_FALSE(observer.error());
  EXPECT_EQ(observer.metrics().rows_without_ideal, 2u);
  EXPECT_EQ(observer.metrics().gentle.rows, 0u);
}

TEST(IdealTrajectory, MeansAndExtremesAreOverTheRows) {
  const double tilt = 0.5;
  const TipPlace ideal = *ideal_place(kBlock, kRadius, tilt);
  IdealTrajectoryObserver observer(kBlock, {});
  for (const double error : {-3e-5, 1e-5, 4e-5, -2e-5}) {
    observer.on_step(row({ideal.lateral, 0, ideal.height + error}, tilt, 0.0, 3.0));
  }
  const TrajectoryErrors e = observer.metrics().firm;
  EXPECT_NEAR(e.height_mean, 0.0, 1e-17);
  EXPECT_NEAR(e.height_rms, 1e-5 * std::sqrt((9 + 1 + 16 + 4) / 4.0), 1e-17);
  EXPECT_NEAR(e.height_min, -3e-5, 1e-17);
  EXPECT_NEAR(e.height_max, 4e-5, 1e-17);
  EXPECT_GE(e.interpenetration_max, e.interpenetration_mean);
}

}  // namespace
}  // namespace hapbench::ideal_trajectory_test
