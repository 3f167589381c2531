#include "device_model/hands/impedance_hand.hpp"

#include <gtest/gtest.h>

namespace hapbench::impedance_hand_test {
namespace {

TEST(ImpedanceHand, IsASpringAndADamperFromTargetToHandle) {
  ImpedanceHand hand(100.0, 10.0, {Profile::Shape(Profile::Ramp{1.0, 2.0}), 5.0, 0.0});
  const HandView view{{{1, 5, -1}, {2, 0, 3}}, {}, {9, 9, 9}};
  // At t = 3 the target is at x = 7 and moves at 2 m/s.
  EXPECT_EQ(hand.force(3.0, view), Vec3(100 * 6 + 10 * 0, 0, 100 * 1 - 10 * 3));
}

TEST(ImpedanceHand, DoesNotPushOnATargetItMovesWith) {
  ImpedanceHand hand(100.0, 10.0, {Profile::Shape(Profile::Ramp{0.0, 1.0}), 0.0, 0.0});
  EXPECT_EQ(hand.force(2.0, {{{2, 0, 0}, {1, 0, 0}}, {}, {}}), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench::impedance_hand_test
