#include "sim/task/target_task.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace hapbench {
namespace {

constexpr double kStep = 1.0 / 1024;  // sums of it are exact
constexpr int kSecond = 1024;

/// One target in the origin, the thesis's times.
TargetRules one_target() {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  rules.targets_per_place = 1;
  return rules;
}

void advance(TargetTask& task, int samples, const Vec3& tip, double press) {
  for (int i = 0; i < samples; ++i) task.advance(tip, press, kStep);
}

const Vec3 kOn{0, 0, 0}, kOff{0.001, 0, 0};

TEST(TargetTask, ATargetHeldForASecondIsRemoved) {
  TargetTask task(one_target(), 1);
  advance(task, kSecond - 1, kOn, 1.0);
  EXPECT_FALSE(task.finished());
  advance(task, 1, kOn, 1.0);
  ASSERT_TRUE(task.finished());
  EXPECT_TRUE(task.results()[0].removed);
  EXPECT_EQ(task.results()[0].time, 1.0);
}

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

TEST(TargetTask, NothingHappensAfterTheEnd) {
  TargetTask task(one_target(), 1);
  advance(task, 3 * kSecond, kOn, 1.0);
  EXPECT_EQ(task.results().size(), 1u);
}

TEST(TargetTask, OnlyTheComponentsOnDisplayCount) {
  TargetRules rules = one_target();
  rules.places = {Vec3(1, 2, 3)};
  EXPECT_EQ(TargetTask(rules, 1).error({0, 0, 0}), Vec3(1, 2, 0));
  rules.display = TargetDisplay::height;
  EXPECT_EQ(TargetTask(rules, 1).error({0, 0, 0}), Vec3(0, 0, 3));
}

TEST(TargetTask, TheToleranceIsADistanceAndBelongsToTheTarget) {
  TargetRules rules = one_target();
  rules.tolerance = 5.0;
  const TargetTask task(rules, 1);
  EXPECT_TRUE(task.on_target({3, 4, 100}));
  EXPECT_FALSE(task.on_target({3, 4.001, 0}));
}

std::vector<std::size_t> order_of(TargetTask task) {
  std::vector<std::size_t> order;
  for (; !task.finished(); advance(task, kSecond, task.rules().places[order.back()], 1.0))
    order.push_back(task.place());
  return order;
}

TEST(TargetTask, EveryPlaceComesEquallyOftenInAnOrderOfTheSeed) {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  rules.targets_per_place = 5;
  std::vector<std::vector<std::size_t>> orders;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<std::size_t> order = order_of(TargetTask(rules, seed));
    ASSERT_EQ(order.size(), 15u);
    for (std::size_t place = 0; place < 3; ++place) EXPECT_EQ(std::count(order.begin(), order.end(), place), 5);
    EXPECT_EQ(order_of(TargetTask(rules, seed)), order);
    orders.push_back(order);
  }
  // 15! / 5!^3 = 756 756 orders: twenty equal pairs are out of the question.
  std::sort(orders.begin(), orders.end());
  EXPECT_EQ(std::unique(orders.begin(), orders.end()), orders.end());
}

TEST(TargetTask, AResetShowsTheSameTargetsAgain) {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  TargetTask task(rules, 3);
  const std::size_t first = task.place();
  advance(task, 7 * kSecond, rules.places[first], 1.0);
  task.reset();
  EXPECT_EQ(task.number(), 0u);
  EXPECT_EQ(task.place(), first);
  EXPECT_FALSE(task.active());
}

}  // namespace
}  // namespace hapbench
