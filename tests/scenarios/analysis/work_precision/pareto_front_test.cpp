#include "scenarios/analysis/work_precision/pareto_front.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace hapbench::pareto_front_test {
namespace {

using Points = std::vector<CostAndError>;
using Indices = std::vector<std::size_t>;

TEST(ParetoFront, HasThePointsThatNoOtherBeats) {
  EXPECT_EQ(pareto_front(Points{}), Indices{});
  // Point 1 is worse than point 0 in both cost and error. Point 4 costs as much as point 2 and has a larger error.
  const Points points = {{1, 10}, {2, 20}, {3, 5}, {9, 1}, {3, 6}};
  EXPECT_EQ(pareto_front(points), (Indices{0, 2, 3}));
  EXPECT_EQ(pareto_front(Points{{2, 1}, {2, 1}}), Indices{0}) << "of equal points the first";
}

TEST(ParetoFront, HasItsKneeFarthestBelowTheChord) {
  // In logarithms to the base 10: (0, 0), (1, -3), (2, -3.5), (3, -4). The chord is y = -4/3 x, and (1, -3) is farthest
  // below it.
  const Points bent = {{1, 1}, {10, 1e-3}, {100, std::pow(10.0, -3.5)}, {1000, 1e-4}};
  EXPECT_EQ(knee(bent, pareto_front(bent)), 1u);
}

TEST(ParetoFront, HasNoKneeIfItIsStraightOrShort) {
  Points straight, upwards;
  for (int i = 0; i < 6; ++i) {
    straight.push_back({std::pow(2.0, i), std::pow(4.0, -i)});
    upwards.push_back({std::pow(2.0, i), std::exp(-0.1 * i * i)});
  }
  EXPECT_EQ(knee(straight, pareto_front(straight)), std::nullopt);
  EXPECT_EQ(knee(upwards, pareto_front(upwards)), std::nullopt);
  const Points three = {{1, 1}, {2, 1e-3}, {1000, 1e-4}};
  EXPECT_EQ(knee(three, pareto_front(three)), std::nullopt);
  EXPECT_EQ(knee({}, {}), std::nullopt);
}

}  // namespace
}  // namespace hapbench::pareto_front_test
