#include "scenarios/input/memory_limit.hpp"

#include <gtest/gtest.h>

#include "scenarios/input/input_error.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::memory_limit_test {
namespace {

TEST(MemoryLimit, RefusesWorkBeyondIt) {
  limit_memory(8e9);
  EXPECT_EQ(memory_limit(), 8e9);
  require_memory(8e9, "the points");
  const auto error = test::input_error_of([] { require_memory(9e9, "the points"); });
  ASSERT_TRUE(error);
  EXPECT_EQ(std::string(error->what()),
            "the points would take about 9 GB; allowed: 8 GB, three quarters of what was free or what --memory sets");
  limit_memory({});
  EXPECT_GT(memory_limit(), 1e8);
  EXPECT_LT(memory_limit(), 1e15) << "of a machine's memory";
}

TEST(MemoryLimitDeathTest, HoldsForEveryAllocation) {
#ifdef HAPBENCH_SANITIZED
  GTEST_SKIP() << "the kernel keeps no limit under sanitizers, whose own maps would exceed it";
#endif
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto take = [] {
    limit_memory(256e6);
    try {
      const std::vector<char> much(std::size_t{1} << 30, 'x');
      std::exit(much.back());
    } catch (const std::bad_alloc&) {
      std::exit(17);
    }
  };
  EXPECT_EXIT(take(), testing::ExitedWithCode(17), "");
}

}  // namespace
}  // namespace hapbench::memory_limit_test
