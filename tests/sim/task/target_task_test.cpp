#include "sim/task/target_task.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapbench::target_task_test {
namespace {

constexpr double kStep = 1.0 / 1024;  // sums of this step are exact
constexpr int kSecond = 1024;

/// Returns rules with one target at the origin. All times have their default values, which are those of the thesis.
TargetRules one_target() {
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0)};
  rules.targets_per_position = 1;
  return rules;
}

void advance(TargetTask& task, int samples, const Vec3& tip, double press) {
  for (int i = 0; i < samples; ++i) task.advance(tip, press, press, kStep);
}

const Vec3 kOn{0, 0, 0}, kOff{0.001, 0, 0};

TEST(TargetTask, LeavingOrLettingGoStartsTheHoldAnew) {
  for (const auto& [tip, press] : {std::pair(kOff, 1.0), std::pair(kOn, 0.999)}) {
    TargetTask task(one_target(), 1);
    advance(task, kSecond - 1, kOn, 1.0);
    advance(task, 1, tip, press);
    advance(task, kSecond - 1, kOn, 1.0);
    EXPECT_FALSE(task.finished());
    advance(task, 1, kOn, 1.0);
    ASSERT_TRUE(task.finished());
    EXPECT_EQ(task.results()[0].time, 2.0);
  }
}

TEST(TargetTask, ALowForceDoesWhatTheThresholdSays) {
  constexpr int kLow = 10;
  for (const auto& [low, time] :
       {std::pair(LowForce::restarts, 1.0 + (500 + kLow) * kStep), std::pair(LowForce::pauses, 1.0 + kLow * kStep),
        std::pair(LowForce::nothing, 1.0), std::pair(LowForce::closes, 10.0)}) {
    TargetRules rules = one_target();
    rules.threshold = Threshold{.low = low};
    TargetTask task(rules, 1);
    advance(task, 500, kOn, 1.0);
    advance(task, kLow, kOn, 0.999);
    EXPECT_EQ(task.finished(), low == LowForce::closes);
    advance(task, 2 * kSecond, kOn, 1.0);
    EXPECT_EQ(task.results()[0].removed, low != LowForce::closes);
    EXPECT_EQ(task.results()[0].time, time);
  }
}

/// Returns rules with a gauge whose grace time is a whole number of samples.
TargetRules with_gauge(double cutoff, double grace) {
  TargetRules rules = one_target();
  rules.gauge = Gauge{cutoff, grace};
  return rules;
}

TEST(ForceGauge, ShowsAStepAsAFirstOrderLowPassDoes) {
  const double cutoff = 30.0, pi = std::numbers::pi;
  TargetTask task(with_gauge(cutoff, 0.1), 1);
  for (int i = 1; i <= kSecond; ++i) {
    task.advance(kOff, 2.0, 2.0, kStep);
    // The tolerance covers 1024 rounding errors of a number of at most 2. The low-pass reduces each error with time.
    ASSERT_NEAR(task.reading(), 2.0 * -std::expm1(-2.0 * pi * cutoff * i * kStep), 1e-13) << i;
  }
}

TEST(ForceGauge, ADropoutBreaksTheHoldIfItIsLongerThanTheGrace) {
  constexpr int kGrace = 100;
  for (const int dropout : {1, 50, kGrace, kGrace + 1, 2 * kGrace}) {
    TargetTask task(with_gauge(1e6, kGrace * kStep), 1);  // the low-pass is so fast that the gauge shows its input
    advance(task, 500, kOn, 2.0);
    advance(task, dropout, kOn, 0.0);
    while (!task.finished()) advance(task, 1, kOn, 2.0);
    EXPECT_TRUE(task.results()[0].removed);
    EXPECT_EQ(task.results()[0].time, dropout <= kGrace ? 1.0 : 1.0 + (500 + dropout) * kStep) << dropout;
  }
}

TEST(ForceGauge, DipsThatAreShortEachDoNotAddUp) {
  TargetTask task(with_gauge(1e6, 10 * kStep), 1);
  for (int i = 0; i < kSecond / 16; ++i) {
    advance(task, 6, kOn, 2.0);
    advance(task, 10, kOn, 0.0);
  }
  ASSERT_TRUE(task.finished());
  EXPECT_EQ(task.results()[0].time, 1.0);
}

TEST(ForceGauge, GraceNeitherActivatesATargetNorCarriesOverFromTheLast) {
  TargetRules rules = with_gauge(1e6, 0.1);
  rules.targets_per_position = 2;
  TargetTask task(rules, 1);
  advance(task, 10, kOn, 0.999);
  EXPECT_FALSE(task.active());
  advance(task, kSecond, kOn, 2.0);
  ASSERT_EQ(task.number(), 1u);
  advance(task, 10, kOn, 0.0);
  EXPECT_FALSE(task.active());
}

TEST(Threshold, IsCheckedWhateverTheGaugeShows) {
  TargetRules rules = with_gauge(1e6, 0.1);
  rules.threshold = Threshold{};
  TargetTask task(rules, 1);
  task.advance(kOn, 2.0, 0.999, kStep);
  EXPECT_EQ(task.reading(), 2.0);
  EXPECT_FALSE(task.active());
  for (int i = 0; i < kSecond - 1; ++i) task.advance(kOn, 0.0, 1.0, kStep);
  EXPECT_TRUE(task.active());
  // A single sample below the threshold interrupts the hold, whatever the grace time of the gauge is.
  task.advance(kOn, 2.0, 0.999, kStep);
  for (int i = 0; i < kSecond - 1; ++i) task.advance(kOn, 0.0, 1.0, kStep);
  EXPECT_FALSE(task.finished());
  task.advance(kOn, 0.0, 1.0, kStep);
  EXPECT_TRUE(task.finished());
}

TEST(Threshold, MayBeOnTheSpringForceThroughALowPassWithAGrace) {
  const int grace = 100;
  TargetRules rules = one_target();
  rules.threshold = Threshold{PressForce::spring, 30.0, grace * kStep};
  // The force steps between 0 and 1.6 N, and the low-pass has the cutoff f = 30 Hz. After a rise, the filtered force
  // stays below 1 N for ln(1.6 / 0.6) / (2 pi f), 5 samples. After a fall, it stays above 1 N for ln(1.6) / (2 pi f), 2
  // samples. If the force is 0 for n samples, the filtered force is therefore below 1 N for n + 3 samples.
  for (const int dropout : {grace - 3, grace - 2}) {
    TargetTask task(rules, 1);
    int samples = 0;
    for (; !task.active(); ++samples) task.advance(kOn, 1.6, 0.0, kStep);
    EXPECT_EQ(samples, 6);
    EXPECT_EQ(task.reading(), 0.0) << "without a gauge the rendered force is shown";
    for (int i = 0; i < 200; ++i) task.advance(kOn, 1.6, 0.0, kStep);
    for (int i = 0; i < dropout; ++i) task.advance(kOn, 0.0, 0.0, kStep);
    while (!task.finished()) task.advance(kOn, 1.6, 0.0, kStep);
    EXPECT_EQ(task.results()[0].time == 1.0, dropout + 3 <= grace) << dropout;
  }
}

TEST(TargetTask, ATargetDisappearsTenSecondsAfterItsActivation) {
  TargetTask task(one_target(), 1);
  advance(task, 5 * kSecond, kOff, 0.0);
  EXPECT_FALSE(task.active());
  advance(task, 1, kOff, 1.0);
  EXPECT_TRUE(task.active());
  advance(task, 10 * kSecond - 2, kOff, 0.0);
  EXPECT_FALSE(task.finished());
  advance(task, 1, kOff, 0.0);
  ASSERT_TRUE(task.finished());
  EXPECT_FALSE(task.results()[0].removed);
  EXPECT_EQ(task.results()[0].time, 10.0);
}

TEST(TargetTask, ATargetThatNobodyActivatesDisappearsToo) {
  TargetTask task(one_target(), 1);
  advance(task, 10 * kSecond - 1, kOn, 0.0);
  EXPECT_FALSE(task.finished());
  advance(task, 1, kOn, 0.0);
  ASSERT_TRUE(task.finished());
  EXPECT_FALSE(task.results()[0].removed);
}

TEST(TargetTask, OnlyTheComponentsOnDisplayCount) {
  TargetRules rules = one_target();
  rules.positions = {Vec3(1, 2, 3)};
  EXPECT_EQ(TargetTask(rules, 1).error({0, 0, 0}), Vec3(1, 2, 0));
  rules.display = TargetDisplay::height;
  EXPECT_EQ(TargetTask(rules, 1).error({0, 0, 0}), Vec3(0, 0, 3));
}

std::vector<std::size_t> order_of(TargetTask task) {
  std::vector<std::size_t> order;
  for (; !task.finished(); advance(task, kSecond, task.rules().positions[order.back()], 1.0))
    order.push_back(task.position_index());
  return order;
}

TEST(TargetTask, EveryPositionComesEquallyOftenInAnOrderOfTheSeed) {
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  rules.targets_per_position = 5;
  std::vector<std::vector<std::size_t>> orders;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<std::size_t> order = order_of(TargetTask(rules, seed));
    ASSERT_EQ(order.size(), 15u);
    for (std::size_t position = 0; position < 3; ++position)
      EXPECT_EQ(std::count(order.begin(), order.end(), position), 5);
    EXPECT_EQ(order_of(TargetTask(rules, seed)), order);
    orders.push_back(order);
  }
  // There are 15! / 5!^3 = 756 756 orders, so a pair of equal orders among twenty is practically impossible.
  std::sort(orders.begin(), orders.end());
  EXPECT_EQ(std::unique(orders.begin(), orders.end()), orders.end());
}

}  // namespace
}  // namespace hapbench::target_task_test
