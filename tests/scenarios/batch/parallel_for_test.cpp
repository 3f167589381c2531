#include "scenarios/batch/parallel_for.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hapbench::parallel_for_test {
namespace {

TEST(ForEachJob, HasAsManyThreadsAsJobsAtOnceEvenOnASmallerMachine) {
  // Each of four waits until all four have begun: with fewer threads none would ever come to its end.
  std::latch begun(4);
  for_each_job(4, {4, ""}, [&](std::size_t) { begun.arrive_and_wait(); });
}

TEST(ForEachJob, BeginsThemInOrderAndNoMoreThanItsThreads) {
  for (const unsigned threads : {1u, 2u, 7u}) {
    std::atomic<std::size_t> ended = 0;
    for_each_job(400, {threads, ""}, [&](std::size_t i) {
      // All before this one have begun, and all of them but threads - 1 have ended.
      EXPECT_LT(i, ended + threads);
      std::this_thread::yield();
      ++ended;
    });
    EXPECT_EQ(ended, 400u);
  }
}

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
  // All fail: the first one is begun before any other and is the lowest.
  for (const unsigned threads : {1u, 4u})
    EXPECT_THROW(for_each_job(50, {threads, ""},
                              [](std::size_t i) {
                                if (i == 0) throw std::domain_error("first");
                                throw std::runtime_error("later");
                              }),
                 std::domain_error);
}

}  // namespace
}  // namespace hapbench::parallel_for_test
