#include "sim/geometry/point_shell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <thread>
#include <vector>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/grid_index.hpp"

namespace hapbench::point_shell_test {
namespace {

PointShell plane_shell() {
  return {surface_points(Plane{0.004, 0.0001}), 0.0001};
}

TEST(PointShell, BuildsItsGridOnceForItselfAndItsCopies) {
  const PointShell shell = plane_shell();
  std::vector<PointShell> copies = {shell};
  const GridIndex& grid = shell.grid();
  copies.push_back(shell);
  EXPECT_EQ(&shell.grid(), &grid);
  for (const PointShell& copy : copies) EXPECT_EQ(&copy.grid(), &grid);
  EXPECT_NE(&plane_shell().grid(), &grid);
}

TEST(PointShell, GivesTheSameGridToSearchesOfSeveralThreads) {
  const PointShell shell = plane_shell();
  std::array<const GridIndex*, 4> grids{};
  std::array<std::size_t, 4> bounds{};
  {
    std::array<std::jthread, 4> threads;
    for (std::size_t i = 0; i < threads.size(); ++i)
      threads[i] = std::jthread([&, i] {
        grids[i] = &shell.grid();
        bounds[i] = shell.max_points_in_ball(0.0005);
      });
  }
  for (std::size_t i = 0; i < grids.size(); ++i) {
    EXPECT_EQ(grids[i], &shell.grid());
    EXPECT_EQ(bounds[i], max_points_in_cube(shell, 0.0005));
  }
}

TEST(PointShell, RemembersTheBoundOfEachRadius) {
  const PointShell shell = plane_shell();
  for (int round = 0; round < 2; ++round) {
    for (const double radius : {0.0005, 0.001, 0.0002})
      EXPECT_EQ(shell.max_points_in_ball(radius), max_points_in_cube(shell, radius)) << radius;
  }
  EXPECT_LT(shell.max_points_in_ball(0.0002), shell.max_points_in_ball(0.001));
  EXPECT_EQ(PointShell({}, 0.0).max_points_in_ball(0.001), 0U);
}

}  // namespace
}  // namespace hapbench::point_shell_test
