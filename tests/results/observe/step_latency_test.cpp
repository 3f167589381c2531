#include "results/observe/step_latency.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace hapbench::step_latency_test {
namespace {

using Times = std::vector<std::uint64_t>;

/// 1 … n in a scrambled order: 7919 is a prime that divides no n below.
Times scrambled(std::uint64_t n) {
  Times times(n);
  for (std::uint64_t i = 0; i < n; ++i) times[i] = 1 + i * 7919 % n;
  return times;
}

// Of 1 … n, the value of rank r is r.
TEST(StepLatency, PercentilesAreThoseOfNearestRank) {
  const StepLatency thousand = step_latency(scrambled(1000), 0);
  EXPECT_EQ(thousand.p50, 500u);
  EXPECT_EQ(thousand.p95, 950u);
  EXPECT_EQ(thousand.p99, 990u);
  EXPECT_EQ(thousand.p99_9, 999u);
  EXPECT_EQ(thousand.max, 1000u);
  const StepLatency seven = step_latency(scrambled(7), 0);  // ranks ceil(3.5), ceil(6.65), ceil(6.93), ceil(6.993)
  EXPECT_EQ(seven.p50, 4u);
  EXPECT_EQ(seven.p95, 7u);
  EXPECT_EQ(seven.p99_9, 7u);
  const StepLatency one = step_latency(Times{42}, 0);
  EXPECT_EQ(one.p50, 42u);
  EXPECT_EQ(one.p99_9, 42u);
}

// By definition: at least p percent of the steps are as short as the percentile, and fewer are shorter.
TEST(StepLatency, PercentilesSplitTheStepsAsDefined) {
  for (std::uint64_t n = 1; n < 300; ++n) {
    Times times = scrambled(n);
    for (std::uint64_t& time : times) time = time * time / 7;  // with repetitions
    const StepLatency latency = step_latency(times, 0);
    const std::pair<double, std::uint64_t> percentiles[] = {
        {0.5, latency.p50}, {0.95, latency.p95}, {0.99, latency.p99}, {0.999, latency.p99_9}};
    for (const auto& [p, value] : percentiles) {
      const auto up_to = std::count_if(times.begin(), times.end(), [v = value](auto time) { return time <= v; });
      const auto below = std::count_if(times.begin(), times.end(), [v = value](auto time) { return time < v; });
      EXPECT_GE(static_cast<double>(up_to), p * static_cast<double>(n) - 1e-9) << n;
      EXPECT_LT(static_cast<double>(below), p * static_cast<double>(n) + 1e-9) << n;
    }
  }
}

TEST(StepLatency, AStepThatTakesExactlyTheDeadlineDoesNotMissIt) {
  // 1/2048 s is 488 281.25 ns.
  const StepLatency latency = step_latency(Times{488'281, 488'282, 500'000, 500'001}, 0);
  EXPECT_EQ(latency.misses[0], 1u);
  EXPECT_EQ(latency.misses[1], 3u);
}

TEST(StepLatency, HistogramHoldsEveryStepOnceBetweenPowersOfTwo) {
  Times times = scrambled(5000);
  times.push_back(5'000'000'000);  // more than 32 bits hold
  const StepLatency latency = step_latency(times, 0);
  std::uint64_t steps = 0;
  for (std::size_t i = 0; i < latency.histogram.size(); ++i) {
    const StepLatency::Bin& bin = latency.histogram[i];
    EXPECT_EQ(bin.steps, static_cast<std::uint64_t>(std::count_if(
                             times.begin(), times.end(), [&](auto t) { return t >= bin.from && t < bin.to; })));
    EXPECT_EQ(bin.from, i > 0 ? latency.histogram[i - 1].to : bin.from);
    steps += bin.steps;
  }
  EXPECT_EQ(steps, times.size());
  EXPECT_GT(latency.histogram.front().steps, 0u);
  EXPECT_GT(latency.histogram.back().steps, 0u);
}

TEST(StepLatency, WithoutStepsThereAreNoPercentiles) {
  const auto json = step_latency_json(step_latency({}, 21));
  EXPECT_EQ(json["steps"], 0);
  EXPECT_EQ(json["clock_overhead_s"], 21e-9);
  for (const char* key : {"p50_s", "p95_s", "p99_s", "p99_9_s", "max_s"}) EXPECT_TRUE(json[key].is_null()) << key;
  EXPECT_TRUE(json["histogram"].empty());
  for (const auto& miss : json["deadline_misses"]) EXPECT_EQ(miss["steps"], 0);
}

TEST(StepLatency, JsonIsInSeconds) {
  const auto json = step_latency_json(step_latency(Times{3, 600'000}, 0));
  EXPECT_EQ(step_latency_json(step_latency(Times{5'000'000'000}, 0))["max_s"], 5.0);
  EXPECT_EQ(json["p50_s"], 3e-9);
  EXPECT_EQ(json["max_s"], 600e-6);
  EXPECT_EQ(json["deadline_misses"][0]["deadline_s"], 0.0005);
  EXPECT_EQ(json["deadline_misses"][1]["deadline_s"], 1.0 / 2048.0);
  EXPECT_EQ(json["histogram"][0]["from_s"], 2e-9);
  EXPECT_EQ(json["histogram"][0]["to_s"], 4e-9);
}

TEST(StepLatency, GivesMediansOverTheRun) {
  Times times;
  for (std::uint64_t i = 0; i < 10 * StepLatency::kSpans; ++i) times.push_back(100 * (i / 10) + i % 10);
  const std::vector<std::uint64_t> medians = step_latency(times, 0).over_time;
  ASSERT_EQ(medians.size(), StepLatency::kSpans);
  for (std::uint64_t span = 0; span < medians.size(); ++span) EXPECT_EQ(medians[span], 100 * span + 4);
  EXPECT_EQ(step_latency(Times{5, 3, 4}, 0).over_time, (Times{5, 3, 4})) << "no more spans than steps";
  EXPECT_TRUE(step_latency({}, 0).over_time.empty());
}

}  // namespace
}  // namespace hapbench::step_latency_test
