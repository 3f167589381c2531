#include "scenarios/batch/sweep_points.hpp"

#include <gtest/gtest.h>

#include "scenarios/batch/shard.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::sweep_points_test {
namespace {

using Values = std::vector<std::string>;

TEST(Grid, HasAllCombinationsTheLastAxisFastest) {
  const SweepPoints grid({{"a", {"1", "2"}}, {"b", {"x"}}, {"c", {"p", "q", "r"}}});
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid.values(0), (Values{"1", "x", "p"}));
  EXPECT_EQ(grid.values(1), (Values{"1", "x", "q"}));
  EXPECT_EQ(grid.values(3), (Values{"2", "x", "p"}));
  EXPECT_EQ(grid.values(5), (Values{"2", "x", "r"}));
  EXPECT_EQ(grid.overrides(4), (Values{"a=2", "b=x", "c=q"}));
}

TEST(Grid, RefusesAFieldTwice) {
  EXPECT_TRUE(test::input_error_of([] { SweepPoints({{"a", {"1"}}, {"b", {"1"}}, {"a", {"2"}}}); }));
}

TEST(Grid, RefusesMoreRunsThanItMayHaveHoweverMany) {
  const Values thousand(1000, "0");
  EXPECT_EQ(SweepPoints({{"a", thousand}, {"b", thousand}}).size(), kMostRuns);
  EXPECT_TRUE(test::input_error_of([&] { SweepPoints({{"a", thousand}, {"b", thousand}, {"c", {"0", "1"}}}); }));
  // 1000^7 is beyond 64 bits.
  std::vector<Axis> axes;
  for (const char* path : {"a", "b", "c", "d", "e", "f", "g"}) axes.push_back({path, thousand});
  EXPECT_TRUE(test::input_error_of([&] { SweepPoints grid(axes); }));
}

TEST(Shard, IsReadFromItsText) {
  const Shard shard = parse_shard("2/7");
  EXPECT_EQ(shard.index, 2u);
  EXPECT_EQ(shard.count, 7u);
  EXPECT_EQ(shard_text(shard), "2/7");
  for (const char* text :
       {"", "/", "1", "1/", "/2", "2/2", "0/0", "-1/2", "1/2/3", "a/b", "0/1000001", "0 /2", "1.5/2"}) {
    EXPECT_TRUE(test::input_error_of([&] { parse_shard(text); })) << text;
  }
}

TEST(Shard, SharesOutEveryRunOnce) {
  for (const std::size_t runs : {0u, 1u, 6u, 7u, 100u}) {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 120u}) {
      std::size_t sum = 0;
      for (std::size_t index = 0; index < count; ++index) {
        const Shard shard{index, count};
        std::size_t own = 0;
        for (std::size_t run = 0; run < runs; ++run) own += run % count == index ? 1 : 0;
        EXPECT_EQ(shard.size(runs), own) << index << "/" << count << " of " << runs;
        sum += own;
      }
      EXPECT_EQ(sum, runs);
    }
  }
}

}  // namespace
}  // namespace hapbench::sweep_points_test
