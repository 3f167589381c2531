#include "results/observe/approach.hpp"

#include <gtest/gtest.h>

#include "tests/results/rows.hpp"

namespace hapbench::approach_test {
namespace {

/// The approach of a tool whose tip centre is at these places, a second apart, to the cube from -1 to 1.
Approach approach_of(const std::vector<Vec3>& places) {
  const ContactBuffer none(1);
  ApproachObserver observer({-Vec3::Ones(), Vec3::Ones()});
  for (std::size_t k = 0; k < places.size(); ++k) {
    StepRecord row = test::row(k, static_cast<double>(k), none);
    row.tool.pose.position = places[k];
    observer.on_step(row);
  }
  return observer.approach();
}

TEST(Approach, IsMeasuredFromTheBoxInEveryDirection) {
  EXPECT_EQ(approach_of({{0, 0, 3}}).last, 2.0);
  EXPECT_EQ(approach_of({{-4, 0, 5}}).last, 5.0);  // from an edge
  EXPECT_EQ(approach_of({{3, 4, -3}}).last, std::sqrt(4.0 + 9.0 + 4.0));
  EXPECT_EQ(approach_of({{0.5, -1, 0}}).last, 0.0);
}

TEST(Approach, KeepsTheFirstOfTheClosestRows) {
  const Approach approach = approach_of({{0, 0, 9}, {0, 0, 3}, {3, 0, 0}, {0, 7, 0}});
  EXPECT_EQ(approach.closest, 2.0);
  EXPECT_EQ(approach.closest_time, 1.0);
  EXPECT_EQ(approach.last, 6.0);
}

}  // namespace
}  // namespace hapbench::approach_test
