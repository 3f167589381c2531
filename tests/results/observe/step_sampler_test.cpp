#include "results/observe/step_sampler.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "tests/results/rows.hpp"

namespace hapbench::step_sampler_test {
namespace {

using std::chrono::milliseconds;

/// Samples of rows between which a step takes at least `step`, and observers at least `watching` in each.
std::vector<std::uint64_t> samples(std::uint64_t steps, milliseconds step, milliseconds watching) {
  const ContactBuffer none(1);
  StepSampler sampler(steps);
  for (std::uint64_t k = 0; k < steps; ++k) {
    std::this_thread::sleep_for(step);
    const StepRecord row = test::row(k, 0.0, none);
    sampler.first().on_step(row);
    std::this_thread::sleep_for(watching);
    sampler.last().on_step(row);
  }
  return {sampler.nanoseconds().begin(), sampler.nanoseconds().end()};
}

TEST(StepSampler, LeavesOutWhatObserversTake) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<std::uint64_t> times = samples(3, milliseconds(0), milliseconds(5));
  const auto passed = std::chrono::nanoseconds(std::chrono::steady_clock::now() - start);
  ASSERT_EQ(times.size(), 2u);  // no row follows the last
  // Observers took 5 ms three times, and perhaps longer on a busy machine: the samples are parts of the rest.
  EXPECT_LE(std::accumulate(times.begin(), times.end(), std::int64_t{0}), (passed - milliseconds(15)).count());
}

TEST(StepSampler, SeesTheStep) {
  for (const std::uint64_t time : samples(10, milliseconds(2), milliseconds(0))) EXPECT_GE(time, 1'900'000u);
}

TEST(StepSampler, TakesAFewOfManySteps) {
  EXPECT_EQ(samples(8, milliseconds(0), milliseconds(0)).size(), 7u);
  EXPECT_TRUE(samples(1, milliseconds(0), milliseconds(0)).empty());
  const std::uint64_t many = 40 * StepSampler::kMostSamples;
  const std::size_t taken = samples(many, milliseconds(0), milliseconds(0)).size();
  EXPECT_LE(taken, StepSampler::kMostSamples);
  EXPECT_GT(taken, StepSampler::kMostSamples / 2);
}

}  // namespace
}  // namespace hapbench::step_sampler_test
