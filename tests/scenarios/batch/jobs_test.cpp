#include "scenarios/batch/jobs.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace hapbench::jobs_test {
namespace {

TEST(ForEachJob, BeginsEachOnceInOrderAndNoMoreThanItsThreads) {
  for (const unsigned threads : {1u, 2u, 7u}) {
    std::atomic<std::size_t> ended = 0;
    for_each_job(400, {threads, ""}, [&](std::size_t i) {
      // When job i runs, all earlier jobs have begun, and at most threads - 1 of them have not ended.
      EXPECT_LT(i, ended + threads);
      std::this_thread::yield();
      ++ended;
    });
    EXPECT_EQ(ended, 400u);
  }
}

TEST(ForEachJob, ThrowsWhatTheLowestFailingJobThrew) {
  // All jobs fail. The reported error is the error of the job with the lowest number, which begins before any other
  // job.
  for (const unsigned threads : {1u, 4u})
    EXPECT_THROW(for_each_job(50, {threads, ""},
                              [](std::size_t i) {
                                if (i == 0) throw std::domain_error("first");
                                throw std::runtime_error("later");
                              }),
                 std::domain_error);
}

}  // namespace
}  // namespace hapbench::jobs_test
