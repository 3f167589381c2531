#include "scenarios/batch/parallel_for.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hapbench::parallel_for_test {
namespace {

/// Calls `work` for the runs below `count`, until `stop`.
void for_each_run(
    std::size_t count, std::size_t jobs, const std::function<Delivery(std::size_t)>& work,
    const std::function<bool()>& stop = [] { return false; }) {
  std::size_t begun = 0;  // no lock: that is the promise
  parallel_for([&] { return begun < count && !stop() ? std::optional(begun++) : std::nullopt; }, jobs, work);
}

class ForEachRun : public testing::TestWithParam<std::size_t> {};

TEST_P(ForEachRun, StartsInOrderAndDeliversEachOnceOneDeliveryAtATime) {
  std::multiset<std::size_t> runs;  // no lock either
  std::atomic<std::size_t> delivered = 0;
  for_each_run(400, GetParam(), [&](std::size_t run) {
    // All before this one have started, and all of them but jobs - 1 are delivered.
    EXPECT_LT(run, delivered + GetParam());
    std::this_thread::yield();
    return [&, run] {
      runs.insert(run);
      ++delivered;
    };
  });
  EXPECT_EQ(delivered, 400u);
  EXPECT_EQ(std::set<std::size_t>(runs.begin(), runs.end()).size(), 400u);
}

TEST_P(ForEachRun, StopsAfterThoseInFlight) {
  std::size_t delivered = 0;
  std::atomic<bool> stop = false;
  const auto work = [&](std::size_t run) {
    if (run == 20) stop = true;
    return [&] { ++delivered; };
  };
  for_each_run(10'000, GetParam(), work, [&] { return stop.load(); });
  EXPECT_GE(delivered, 21u);
  EXPECT_LE(delivered, 21u + GetParam());
}

TEST_P(ForEachRun, PassesExceptionsOn) {
  const auto fail_in_work = [](std::size_t run) -> Delivery {
    if (run == 5) throw std::runtime_error("work");
    return {};
  };
  const auto fail_in_delivery = [](std::size_t) -> Delivery { return [] { throw std::runtime_error("delivery"); }; };
  EXPECT_THROW(for_each_run(100, GetParam(), fail_in_work), std::runtime_error);
  EXPECT_THROW(for_each_run(100, GetParam(), fail_in_delivery), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Jobs, ForEachRun, testing::Values(1, 2, 7));

TEST(ForEachRunInParallel, HasAsManyThreadsAsJobsEvenOnASmallerMachine) {
  // Each of four runs waits until all four have begun: with fewer threads none would ever come to its end.
  std::latch begun(4);
  std::size_t delivered = 0;
  for_each_run(4, 4, [&](std::size_t) -> Delivery {
    begun.arrive_and_wait();
    return [&] { ++delivered; };
  });
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

}  // namespace
}  // namespace hapbench::parallel_for_test
