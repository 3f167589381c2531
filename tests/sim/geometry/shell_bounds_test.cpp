#include "sim/geometry/point_shell.hpp"

#include <gtest/gtest.h>

namespace hapbench::shell_bounds_test {
namespace {

TEST(ShellBounds, AreThoseOfThePointsWithoutThePadding) {
  const PointShell shell({{Vec3(1, 5, -2)}, {Vec3(-3, 4, 0)}, {Vec3(2, 4.5, 7)}}, 0.0);
  EXPECT_EQ(shell.bounds().min, Vec3(-3, 4, -2));
  EXPECT_EQ(shell.bounds().max, Vec3(2, 5, 7));
  EXPECT_EQ(PointShell({}, 0.0).bounds().max, Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench::shell_bounds_test
