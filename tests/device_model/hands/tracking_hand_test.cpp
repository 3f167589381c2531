#include "device_model/hands/tracking_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hapbench::tracking_hand_test {
namespace {

constexpr double kStep = 1.0 / 2048;

Subject calm() {
  Subject subject;
  subject.motor_noise = subject.tilt_noise = 0.0;
  return subject;
}

TargetTask one_target(TargetDisplay display, const Vec3& place) {
  TargetRules rules;
  rules.display = display;
  rules.places = {place};
  rules.targets_per_place = 1;
  return {rules, 1};
}

TEST(TrackingHand, DoesNothingBeforeTheReactionDelay) {
  const Subject subject = calm();
  TrackingHand hand(subject, one_target(TargetDisplay::panel, {0.01, 0, 0}), 0.0, kStep, 1);
  HandView view;
  view.model_force.z() = subject.press;  // nothing to correct in z
  const int delay = static_cast<int>(std::lround(subject.reaction_delay / kStep));
  double first_force = -1.0;
  for (int i = 0; i <= delay; ++i) {
    const Vec3 force = hand.force(i * kStep, view);
    if (force.x() != 0.0) {
      first_force = i;
      break;
    }
  }
  EXPECT_EQ(first_force, delay);
}

TEST(TrackingHand, MovesTowardsTheTargetAtTheBandwidthOfTheSubject) {
  Subject subject = calm();
  subject.reaction_delay = 0.0;
  const double error = 0.001;
  TrackingHand hand(subject, one_target(TargetDisplay::panel, {error, -error, 0}), 0.0, kStep, 1);
  HandView view;
  view.model_force.z() = subject.press;
  const Vec3 force = hand.force(0.0, view);
  const double step = 2.0 * std::numbers::pi * subject.bandwidth * error * kStep;
  EXPECT_NEAR(force.x(), subject.stiffness * step, 1e-12);
  EXPECT_NEAR(force.y(), -subject.stiffness * step, 1e-12);
  EXPECT_EQ(force.z(), 0.0);
}

TEST(TrackingHand, PressesHarderOrSofterUntilTheGaugeShowsWhatItWants) {
  Subject subject = calm();
  subject.reaction_delay = 0.0;
  for (const double shown : {0.0, subject.press + 1.0}) {
    TrackingHand hand(subject, one_target(TargetDisplay::panel, {0, 0, 0}), 0.0, kStep, 1);
    HandView view;
    view.model_force.z() = shown;
    const double force = hand.force(0.0, view).z();
    const double change = -2.0 * std::numbers::pi * subject.press_bandwidth * (subject.press - shown) * kStep;
    EXPECT_NEAR(force, change, 1e-12) << "downwards when too little is shown";
  }
}

TEST(TrackingHand, ReadsTheSpringForceFromAGaugeAndTheRenderedForceWithoutOne) {
  HandView view;
  view.model_force.z() = 3.0;
  view.spring_force.z() = 2.0;
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  for (const bool has_gauge : {false, true}) {
    if (has_gauge) rules.gauge = Gauge{1e6, 0.1};  // too fast to filter anything
    TrackingHand hand(calm(), TargetTask(rules, 1), 0.0, kStep, 1);
    hand.force(0.0, view);
    EXPECT_EQ(hand.task()->reading(), has_gauge ? 2.0 : 3.0);
  }
}

TEST(TrackingHand, NeverPushesHarderThanItsStrength) {
  Subject subject = calm();
  TrackingHand hand(subject, one_target(TargetDisplay::panel, {1, 0, 0}), 0.0, kStep, 1);
  double strongest = 0.0;
  for (int i = 0; i < 20 * 2048; ++i) {
    const Vec3 force = hand.force(i * kStep, {});  // a handle that does not give way
    if (hand.finished()) break;
    strongest = std::max(strongest, force.cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(strongest, subject.max_force, 1e-9);
}

TEST(TrackingHand, TurnsTheToolOnlyWithTheHeightDisplay) {
  Subject subject = calm();
  subject.reaction_delay = 0.0;
  const double rise = 0.001;
  TrackingHand panel(subject, one_target(TargetDisplay::panel, {0, 0, rise}), 0.5, kStep, 1);
  TrackingHand height(subject, one_target(TargetDisplay::height, {0.3, 0.3, rise}), 0.5, kStep, 1);
  const Vec3 force = height.force(0.0, {});
  panel.force(0.0, {});
  EXPECT_EQ(panel.tilt(), 0.5);
  const double turn = 2.0 * std::numbers::pi * subject.bandwidth * rise / subject.height_per_tilt * kStep;
  EXPECT_NEAR(height.tilt(), 0.5 + turn, 1e-15) << "the tip rises with the tilt";
  EXPECT_EQ(force.x(), 0.0) << "what is not on display does not count";
}

TEST(TrackingHand, HeldOrientationFollowsTheWrist) {
  Subject subject = calm();
  subject.reaction_delay = 0.0;
  TrackingHand hand(subject, one_target(TargetDisplay::height, {0, 0, 1}), 0.5, kStep, 1);
  const HeldOrientation motion({}, hand);
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR(std::acos(-motion.axis_at(0.0).z()), hand.tilt(), 1e-14);
    hand.force(i * kStep, {});
  }
  EXPECT_GT(hand.tilt(), 0.5);
}

TEST(TrackingHand, NoiseHasTheGivenDeviationAndBandwidth) {
  Subject subject;
  subject.bandwidth = subject.press_bandwidth = 0.0;  // holds still but for the noise
  subject.motor_noise = 0.5;
  subject.noise_bandwidth = 8.0;
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  rules.time_limit = 1e6;
  TrackingHand hand(subject, TargetTask(rules, 1), 0.0, kStep, 7);
  double squares = 0.0, products = 0.0, last = 0.0;
  constexpr int kSamples = 400'000;
  for (int i = 0; i < kSamples; ++i) {
    const double x = hand.force(i * kStep, {}).x();
    squares += x * x;
    products += x * last;
    last = x;
  }
  const double memory = std::exp(-2.0 * std::numbers::pi * subject.noise_bandwidth * kStep);
  // A sum of correlated samples is as good as n (1 - a^2) / (1 + a^2) independent ones: five standard errors.
  const double independent = kSamples * (1.0 - memory * memory) / (1.0 + memory * memory);
  EXPECT_NEAR(squares / kSamples / 0.25, 1.0, 5.0 * std::sqrt(2.0 / independent));
  // 1 - products / squares estimates 1 - a with relative error about sqrt(2 / (n (1 - a))).
  EXPECT_NEAR((1.0 - products / squares) / (1.0 - memory), 1.0, 5.0 * std::sqrt(2.0 / (kSamples * (1.0 - memory))));
}

TEST(TrackingHand, AResetRepeatsEverythingBitForBitAndASeedChangesIt) {
  const auto record = [](TrackingHand& hand) {
    std::vector<Vec3> forces;
    for (int i = 0; i < 3000; ++i) {
      HandView view;
      view.handle.position.x() = 1e-4 * std::sin(0.01 * i);
      view.tool.position = view.handle.position;
      view.model_force.z() = 1.2;
      forces.push_back(hand.force(i * kStep, view));
    }
    return forces;
  };
  TrackingHand hand({}, one_target(TargetDisplay::height, {0, 0, 0.001}), 0.3, kStep, 11);
  const auto first = record(hand);
  hand.reset();
  EXPECT_EQ(record(hand), first);
  TrackingHand other({}, one_target(TargetDisplay::height, {0, 0, 0.001}), 0.3, kStep, 12);
  EXPECT_NE(record(other), first);
}

}  // namespace
}  // namespace hapbench::tracking_hand_test
