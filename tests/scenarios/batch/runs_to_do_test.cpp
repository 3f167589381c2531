#include "scenarios/batch/runs_to_do.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace hapbench::runs_to_do_test {
namespace {

using Numbers = std::vector<std::size_t>;

Numbers all_of(const SweepPoints& points, const Shard& shard = {}) {
  RunsToDo runs(points, shard);
  Numbers all;
  while (const auto run = runs.next()) all.push_back(*run);
  EXPECT_FALSE(runs.next());
  return all;
}

TEST(RunsToDo, AreInOrderWhereTheEnvironmentStaysTheSame) {
  const SweepPoints points({parse_axis("a=1,2"), parse_axis("b=1,2")});
  EXPECT_EQ(all_of(points), (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(all_of(points, {1, 3}), Numbers{1});
  EXPECT_EQ(all_of(points, {4, 5}), Numbers{});
  EXPECT_EQ(environment_of(points, 3), "");
}

TEST(RunsToDo, OfOneEnvironmentFollowEachOther) {
  const SweepPoints points(
      {parse_axis("a=1,2"), parse_axis("environment.spacing_m=1e-3,2e-3,3e-3"), parse_axis("environment.width_m=1,2")});
  EXPECT_EQ(all_of(points), (Numbers{0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11}));
  EXPECT_EQ(all_of(points, {1, 2}), (Numbers{1, 7, 3, 9, 5, 11}));
  EXPECT_EQ(environment_of(points, 1), environment_of(points, 7));
  EXPECT_NE(environment_of(points, 1), environment_of(points, 2));
}

TEST(RunsToDo, OfASampleFollowEachOtherByTheListedFields) {
  const SweepPoints points({parse_sampled_axis("environment.file=x.stl,y.stl"),
                            parse_sampled_axis("environment.scale=1:2"), parse_sampled_axis("a=1:2")},
                           {SamplingMethod::latin_hypercube, 40, 1});
  const Numbers all = all_of(points);
  Numbers sorted = all;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(sorted[i], i);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(points.value(all[i], 0), i < 20 ? "x.stl" : "y.stl");
}

}  // namespace
}  // namespace hapbench::runs_to_do_test
