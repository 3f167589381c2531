#include "device_model/hands/scripted_hands.hpp"

#include <gtest/gtest.h>

namespace hapbench {
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

}  // namespace
}  // namespace hapbench
