#include "scenarios/batch/parallel_for.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hapbench::parallel_for_test {
namespace {

std::vector<std::size_t> numbers_to(std::size_t n) {
  std::vector<std::size_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

bool never() {
  return false;
}

class ForEachRun : public testing::TestWithParam<std::size_t> {};

TEST_P(ForEachRun, DoesAndDeliversEachOnceOneDeliveryAtATime) {
  const std::vector<std::size_t> runs = {7, 3, 500, 3000, 0, 12};
  std::multiset<std::size_t> delivered;  // no lock: that is the promise
  parallel_for(
      runs, GetParam(), [&](std::size_t run) { return [&, run] { delivered.insert(run); }; }, never);
  EXPECT_EQ(delivered, std::multiset<std::size_t>(runs.begin(), runs.end()));
}

TEST_P(ForEachRun, HasNoMoreInFlightThanJobsAndStartsInOrder) {
  std::atomic<std::size_t> delivered = 0;
  parallel_for(
      numbers_to(400), GetParam(),
      [&](std::size_t run) {
        // All before this one have started, and all of them but jobs - 1 are delivered.
        EXPECT_LT(run, delivered + GetParam());
        std::this_thread::yield();
        return [&] { ++delivered; };
      },
      never);
  EXPECT_EQ(delivered, 400u);
}

TEST_P(ForEachRun, StopsAfterThoseInFlight) {
  std::size_t delivered = 0;
  std::atomic<bool> stop = false;
  parallel_for(
      numbers_to(10'000), GetParam(),
      [&](std::size_t run) {
        if (run == 20) stop = true;
        return [&] { ++delivered; };
      },
      [&] { return stop.load(); });
  EXPECT_GE(delivered, 21u);
  EXPECT_LE(delivered, 21u + GetParam());
}

TEST_P(ForEachRun, PassesExceptionsOn) {
  const auto fail_in_work = [](std::size_t run) -> Delivery {
    if (run == 5) throw std::runtime_error("work");
    return {};
  };
  const auto fail_in_delivery = [](std::size_t) -> Delivery { return [] { throw std::runtime_error("delivery"); }; };
  EXPECT_THROW(parallel_for(numbers_to(100), GetParam(), fail_in_work, never), std::runtime_error);
  EXPECT_THROW(parallel_for(numbers_to(100), GetParam(), fail_in_delivery, never), std::runtime_error);
}

TEST_P(ForEachRun, AsksForTheNextRunOneThreadAtATime) {
  std::size_t given = 0;  // no lock
  std::multiset<std::size_t> delivered;
  parallel_for([&]() -> std::optional<std::size_t> { return given < 1000 ? std::optional(given++) : std::nullopt; },
               GetParam(), [&](std::size_t run) { return [&, run] { delivered.insert(run); }; });
  const std::vector<std::size_t> all = numbers_to(1000);
  EXPECT_EQ(delivered, std::multiset<std::size_t>(all.begin(), all.end()));
}

TEST_P(ForEachRun, TakesNoRuns) {
  parallel_for(
      {}, GetParam(), [](std::size_t) -> Delivery { throw std::logic_error("none"); }, never);
}

INSTANTIATE_TEST_SUITE_P(Jobs, ForEachRun, testing::Values(1, 2, 7));

TEST(ForEachRunInParallel, HasAsManyThreadsAsJobsEvenOnASmallerMachine) {
  // Each of four runs waits until all four have begun: with fewer threads none would ever come to its end.
  std::latch begun(4);
  std::size_t delivered = 0;
  parallel_for(
      numbers_to(4), 4,
      [&](std::size_t) -> Delivery {
        begun.arrive_and_wait();
        return [&] { ++delivered; };
      },
      never);
  EXPECT_EQ(delivered, 4u);
}

// ---- Lists of jobs

TEST(ForEachJob, DoesEachOnceOnAnyNumberOfThreads) {
  for (const unsigned threads : {0u, 1u, 2u, 7u, 100u}) {
    for (const std::size_t count : {0u, 1u, 5u, 1000u}) {
      std::vector<std::atomic<int>> done(count);
      for_each_job(count, {threads, ""}, [&](std::size_t i) { ++done[i]; });
      for (const auto& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(ForEachJob, ThrowsWhatTheLowestFailingJobThrew) {
  for (const unsigned threads : {1u, 4u}) {
    // All fail: the first one is begun before any other and is the lowest.
    try {
      for_each_job(50, {threads, ""}, [](std::size_t i) { throw std::runtime_error(std::to_string(i)); });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "0");
    }
  }
}

TEST(ForEachJob, BeginsNothingAfterAFailure) {
  std::size_t begun = 0;
  EXPECT_THROW(for_each_job(1000, {1, ""},
                            [&](std::size_t i) {
                              ++begun;
                              if (i == 10) throw std::runtime_error("ten");
                            }),
               std::runtime_error);
  EXPECT_EQ(begun, 11u);
}

}  // namespace
}  // namespace hapbench::parallel_for_test
