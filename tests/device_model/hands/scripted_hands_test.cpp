#include "device_model/hands/scripted_hands.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace hapbench::scripted_hands_test {
namespace {

TEST(NoHand, NeverPushes) {
  NoHand hand;
  EXPECT_EQ(hand.force(0.0, {}), Vec3(0, 0, 0));
  EXPECT_EQ(hand.force(9.0, {{{1, 2, 3}, {4, 5, 6}}, {}, {7, 8, 9}}), Vec3(0, 0, 0));
}

TEST(ForceHand, PushesWithItsProfilesWhateverTheHandleDoes) {
  ForceHand hand({Profile::Shape(Profile::Ramp{1.0, 2.0}), -3.0, Profile::Shape(Profile::Ramp{0.0, -1.0})});
  EXPECT_EQ(hand.force(0.0, {}), Vec3(1, -3, 0));
  EXPECT_EQ(hand.force(2.0, {}), Vec3(5, -3, -2));
  EXPECT_EQ(hand.force(2.0, {{{1, 2, 3}, {4, 5, 6}}, {}, {7, 8, 9}}), Vec3(5, -3, -2));
  hand.reset();
  EXPECT_EQ(hand.force(0.0, {}), Vec3(1, -3, 0));
}

TEST(PushHand, PushesAlongItsDirectionWithItsProfile) {
  PushHand hand(Profile::Shape(Profile::Ramp{1.0, 2.0}), {0.0, 0.6, -0.8});
  EXPECT_EQ(hand.force(0.0, {}), Vec3(0.0, 0.6, -0.8));
  EXPECT_EQ(hand.force(2.0, {{{1, 2, 3}, {4, 5, 6}}, {}, {7, 8, 9}}), 5.0 * Vec3(0.0, 0.6, -0.8));
}

TEST(PushDirection, LeansFromStraightDownTowardsItsAzimuth) {
  EXPECT_EQ(push_direction(0.0, 1.0), Vec3(0, 0, -1));
  const double eps = 4 * std::numeric_limits<double>::epsilon(), pi = std::numbers::pi;
  EXPECT_LE((push_direction(pi / 2, 0.0) - Vec3::UnitX()).norm(), eps);
  EXPECT_LE((push_direction(pi / 2, pi / 2) - Vec3::UnitY()).norm(), eps);
  EXPECT_LE((push_direction(pi / 6, pi) - Vec3(-0.5, 0.0, -std::sqrt(0.75))).norm(), eps);
  for (const double angle : {-3.0, 0.3, 1.0, 2.0}) {
    for (const double azimuth : {-2.0, 0.0, 5.0}) EXPECT_NEAR(push_direction(angle, azimuth).norm(), 1.0, eps);
  }
}

}  // namespace
}  // namespace hapbench::scripted_hands_test
