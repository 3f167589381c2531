#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "sim/tool/motion.hpp"

namespace hapbench {
namespace {

using Sample = RecordedMotion::Sample;

TEST(RecordedMotion, PassesThroughItsSamples) {
  const RecordedMotion motion({{0.0, {1, 2, 3}, {0, 0, -1}}, {0.5, {4, 5, 6}, {1, 0, 0}}, {2.0, {7, 8, 9}, {0, 1, 0}}});
  EXPECT_EQ(motion.position_at(0.0), Vec3(1, 2, 3));
  EXPECT_EQ(motion.position_at(0.5), Vec3(4, 5, 6));
  EXPECT_EQ(motion.position_at(2.0), Vec3(7, 8, 9));
  EXPECT_EQ(motion.axis_at(0.0), Vec3(0, 0, -1));
  EXPECT_EQ(motion.axis_at(0.5), Vec3(1, 0, 0));
  EXPECT_EQ(motion.axis_at(2.0), Vec3(0, 1, 0));
}

TEST(RecordedMotion, PositionIsLinearBetweenSamples) {
  const RecordedMotion motion({{1.0, {0, 0, 8}, {0, 0, -1}}, {3.0, {4, -8, 8}, {0, 0, -1}}});
  EXPECT_EQ(motion.position_at(1.5), Vec3(1, -2, 8));
  EXPECT_EQ(motion.position_at(2.0), Vec3(2, -4, 8));
}

TEST(RecordedMotion, IsHeldConstantOutside) {
  const RecordedMotion motion({{1.0, {1, 2, 3}, {0, 0, -1}}, {3.0, {4, 5, 6}, {1, 0, 0}}});
  for (const double t : {-1e9, 0.0, 0.999}) {
    EXPECT_EQ(motion.position_at(t), Vec3(1, 2, 3));
    EXPECT_EQ(motion.axis_at(t), Vec3(0, 0, -1));
  }
  for (const double t : {3.001, 1e9}) {
    EXPECT_EQ(motion.position_at(t), Vec3(4, 5, 6));
    EXPECT_EQ(motion.axis_at(t), Vec3(1, 0, 0));
  }
}

TEST(RecordedMotion, AxisIsNormalisedAfterInterpolation) {
  const RecordedMotion motion({{0.0, Vec3::Zero(), {1, 0, 0}}, {1.0, Vec3::Zero(), {0, 1, 0}}});
  const Vec3 half_way = motion.axis_at(0.5);
  // The mean (1/2, 1/2) is exact; its norm and the division round once each.
  EXPECT_NEAR(half_way.x(), std::sqrt(0.5), 2 * std::numeric_limits<double>::epsilon());
  EXPECT_EQ(half_way.x(), half_way.y());
  for (int k = 0; k <= 100; ++k) EXPECT_NEAR(motion.axis_at(k / 100.0).norm(), 1.0, 4e-16);
}

TEST(RecordedMotion, OppositeAxesKeepTheLastDirectionHalfWay) {
  const RecordedMotion motion({{0.0, Vec3::Zero(), {0, 0, 1}}, {1.0, Vec3::Zero(), {0, 0, -1}}});
  EXPECT_EQ(motion.axis_at(0.25), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.5), Vec3(0, 0, 1));
  EXPECT_EQ(motion.axis_at(0.75), Vec3(0, 0, -1));
}

TEST(RecordedMotion, OneSampleIsAStillTool) {
  const RecordedMotion motion({{1.0, {1, 2, 3}, {1, 0, 0}}});
  for (const double t : {0.0, 1.0, 2.0}) {
    EXPECT_EQ(motion.position_at(t), Vec3(1, 2, 3));
    EXPECT_EQ(motion.axis_at(t), Vec3(1, 0, 0));
  }
}

TEST(RecordedMotion, PrescribesThePosition) {
  EXPECT_FALSE(RecordedMotion({Sample{}}).position_is_free());
}

TEST(RecordedMotion, RefusesNoSamplesAndTimesThatDoNotIncrease) {
  EXPECT_THROW(RecordedMotion({}), std::invalid_argument);
  const Vec3 p = Vec3::Zero(), axis = {0, 0, -1};
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{0.0, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{1.0, p, axis}, Sample{0.5, p, axis}}), std::invalid_argument);
  EXPECT_THROW(RecordedMotion({Sample{0.0, p, axis}, Sample{std::nan(""), p, axis}}), std::invalid_argument);
}

}  // namespace
}  // namespace hapbench
