#include "results/observe/step_times.hpp"
#include "results/allocations/allocations.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace hapbench::step_times_test {
namespace {

using Clock = std::chrono::steady_clock;

void busy_for(std::chrono::nanoseconds time) {
  const auto end = Clock::now() + time;
  while (Clock::now() < end) {
  }
}

TEST(StepTimes, TimesEachStep) {
  StepTimes times(3);
  times.start();
  for (const int microseconds : {50, 300, 100}) {
    busy_for(std::chrono::microseconds(microseconds));
    times.lap();
  }
  const auto ns = times.nanoseconds();
  ASSERT_EQ(ns.size(), 3u);
  // A step takes no less than it is busy; the overhead, which was measured, is subtracted once. Longer it may take.
  EXPECT_GE(ns[0] + times.overhead(), 50'000u);
  EXPECT_GE(ns[1] + times.overhead(), 300'000u);
  EXPECT_GE(ns[2] + times.overhead(), 100'000u);
}

// 4.29 s is 2^32 ns. A step that began 5 s ago need not be waited for.
TEST(StepTimes, TimesAStepOfManySeconds) {
  StepTimes times(1);
  times.start(Clock::now() - std::chrono::seconds(5));
  times.lap();
  EXPECT_GE(times.nanoseconds()[0] + times.overhead(), 5'000'000'000u);
}

TEST(StepTimes, AddUpToTheTimeThatPassed) {
  constexpr std::uint64_t kSteps = 1000;
  StepTimes times(kSteps);
  const auto before = Clock::now();
  times.start();
  for (std::uint64_t i = 0; i < kSteps; ++i) {
    busy_for(std::chrono::microseconds(1));
    times.lap();
  }
  const auto passed = std::chrono::nanoseconds(Clock::now() - before).count();
  const auto ns = times.nanoseconds();
  EXPECT_LE(std::accumulate(ns.begin(), ns.end(), std::int64_t{0}), passed);
}

/// Whether more than half of many empty steps take less than a reading of the clock, which is subtracted from each.
bool empty_steps_take_nothing() {
  StepTimes times(10'001);
  times.start();
  for (int i = 0; i < 10'001; ++i) times.lap();
  std::vector<std::uint64_t> ns(times.nanoseconds().begin(), times.nanoseconds().end());
  std::nth_element(ns.begin(), ns.begin() + 5000, ns.end());
  EXPECT_GT(times.overhead(), 0u);
  return ns[5000] <= times.overhead();
}

// A machine that does something else can slow the steps down after the clock was measured, but not every time.
TEST(StepTimes, AnEmptyStepTakesAboutNothing) {
  int attempts = 0;
  while (!empty_steps_take_nothing()) ASSERT_LT(++attempts, 1000);
}

TEST(StepTimes, AStepDoesNotAllocate) {
  StepTimes times(100);
  const AllocationCount count;
  times.start();
  for (int i = 0; i < 100; ++i) times.lap();
  EXPECT_EQ(count.value(), 0u);
  EXPECT_EQ(times.nanoseconds().size(), 100u);
}

}  // namespace
}  // namespace hapbench::step_times_test
