#include "results/observe/step_times.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "results/summary/allocations.hpp"
#include "results/summary/summary.hpp"
#include "tests/results/observing.hpp"

namespace hapbench::step_times_test {
namespace {

using Clock = std::chrono::steady_clock;

// Checks a step that is longer than 2^32 ns = 4.29 s. The test does not wait: the step has a start time 5 s ago.
TEST(StepTimes, TimesAStepOfManySeconds) {
  StepTimes times(1);
  times.start(Clock::now() - std::chrono::seconds(5));
  times.lap();
  EXPECT_GE(times.nanoseconds()[0] + times.overhead(), 5'000'000'000u);
}

TEST(StepTimes, AStepDoesNotAllocate) {
  StepTimes times(100);
  const AllocationCount count;
  times.start();
  for (int i = 0; i < 100; ++i) times.lap();
  EXPECT_EQ(count.value(), 0u);
  EXPECT_EQ(times.nanoseconds().size(), 100u);
  EXPECT_GT(times.overhead(), 0u);
}

using std::chrono::milliseconds;

/// Returns the times [ns] that a StepSampler measures. In each step, the simulation takes the time `step`, and the
/// observers take the time `watching`.
std::vector<std::uint64_t> samples(std::uint64_t steps, milliseconds step, milliseconds watching) {
  const ContactBuffer none(1);
  StepSampler sampler(steps);
  for (std::uint64_t k = 0; k < steps; ++k) {
    std::this_thread::sleep_for(step);
    const StepRecord row = test::row(k, 0.0, none);
    sampler.on_step(row);
    std::this_thread::sleep_for(watching);
    sampler.on_step(row);
  }
  return {sampler.nanoseconds().begin(), sampler.nanoseconds().end()};
}

TEST(StepSampler, LeavesOutWhatObserversTake) {
  const std::vector<std::uint64_t> times = samples(3, milliseconds(0), milliseconds(5));
  ASSERT_EQ(times.size(), 2u);  // no step follows the last step
  // Compare only the shortest sample: other processes of the machine can only make a sample longer, and rarely delay
  // both samples.
  EXPECT_LT(*std::min_element(times.begin(), times.end()), 5'000'000u);
}

TEST(StepSampler, SeesTheStep) {
  for (const std::uint64_t time : samples(10, milliseconds(2), milliseconds(0))) EXPECT_GE(time, 1'900'000u);
}

TEST(StepSampler, TakesAFewOfManySteps) {
  EXPECT_EQ(samples(8, milliseconds(0), milliseconds(0)).size(), 7u);
  EXPECT_TRUE(samples(1, milliseconds(0), milliseconds(0)).empty());
  const std::uint64_t many = 40 * StepSampler::kMaxSamples;
  const std::size_t taken = samples(many, milliseconds(0), milliseconds(0)).size();
  EXPECT_LE(taken, StepSampler::kMaxSamples);
  EXPECT_GT(taken, StepSampler::kMaxSamples / 2);
}

using Times = std::vector<std::uint64_t>;

/// Returns the numbers 1 … n in a scrambled order: 7919 is a prime that divides none of the values of n in these tests.
Times scrambled(std::uint64_t n) {
  Times times(n);
  for (std::uint64_t i = 0; i < n; ++i) times[i] = 1 + i * 7919 % n;
  return times;
}

// Checks the ranks of percentiles. The samples are 1 … n, so the sample of rank r is r.
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
  EXPECT_EQ(step_latency(Times{42}, 0).p99_9, 42u);
}

TEST(StepLatency, AStepThatTakesExactlyTheDeadlineDoesNotMissIt) {
  // The period 1/2048 s is 488 281.25 ns.
  const StepLatency latency = step_latency(Times{488'281, 488'282, 500'000, 500'001}, 0);
  EXPECT_EQ(latency.misses[0], 1u);
  EXPECT_EQ(latency.misses[1], 3u);
}

TEST(StepLatency, HistogramHoldsEveryStepOnceBetweenPowersOfTwo) {
  Times times = scrambled(5000);
  times.push_back(5'000'000'000);  // more than 32 bits
  const StepLatency latency = step_latency(times, 0);
  std::uint64_t steps = 0, end = latency.histogram.front().from;
  for (const StepLatency::Bin& bin : latency.histogram) {
    EXPECT_EQ(static_cast<std::ptrdiff_t>(bin.steps),
              std::ranges::count_if(times, [&](auto t) { return t >= bin.from && t < bin.to; }));
    EXPECT_EQ(bin.from, end);
    end = bin.to;
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
  EXPECT_NE(timing_text({}).find("\"step_mean_s\": null,"), std::string::npos);
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

TEST(Timing, TextHoldsMeanTimeInstructionSetAndCpu) {
  Result run;
  run.end.rows = 2000;
  run.timing = {.loop = 0.5, .latency = step_latency(Times{3, 5'000'000'000}, 0), .step_p50 = 5e-7};
  run.provenance.cpu = "Some CPU";
  run.provenance.widest = "avx2";
  const auto json = nlohmann::json::parse(timing_text(run));
  EXPECT_EQ(json["step_mean_s"], 0.00025);
  EXPECT_EQ(json["step_p50_s"], 5e-7);
  EXPECT_EQ(json["step_latency"]["p50_s"], 3e-9);
  EXPECT_EQ(json["step_latency"]["max_s"], 5.0);
  EXPECT_EQ(json["step_latency"]["deadline_misses"][1]["deadline_s"], 1.0 / 2048.0);
  EXPECT_EQ(json["step_latency"]["histogram"][0]["to_s"], 4e-9);
  EXPECT_EQ(json["build"]["instruction_set"], "avx2");
  EXPECT_EQ(json["cpu"], "Some CPU");
}

}  // namespace
}  // namespace hapbench::step_times_test
