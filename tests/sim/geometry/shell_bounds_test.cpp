#include "sim/geometry/shell_bounds.hpp"

#include <gtest/gtest.h>

namespace hapbench {
namespace {

TEST(ShellBounds, AreThoseOfThePointsWithoutThePadding) {
  const PointShell shell({{Vec3(1, 5, -2)}, {Vec3(-3, 4, 0)}, {Vec3(2, 4.5, 7)}}, 0.0);
  EXPECT_EQ(bounds_of(shell).min, Vec3(-3, 4, -2));
  EXPECT_EQ(bounds_of(shell).max, Vec3(2, 5, 7));
  EXPECT_EQ(bounds_of(PointShell({}, 0.0)).max, Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench
