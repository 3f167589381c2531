#include "sim/geometry/point_shell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <barrier>
#include <cstddef>
#include <optional>
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

/// Threads ask for the grid at the same time. It takes about a millisecond to build, so that without a lock, several
/// threads would build it.
TEST(PointShell, GivesTheSameGridToSearchesOfSeveralThreads) {
  constexpr std::size_t kThreads = 4;
  for (int round = 0; round < 10; ++round) {
    const PointShell shell(surface_points(Plane{0.02, 0.0001}), 0.0001);
    std::array<const GridIndex*, kThreads> grids{};
    std::array<std::size_t, kThreads> bounds{};
    std::barrier start(kThreads);
    {
      std::array<std::jthread, kThreads> threads;
      for (std::size_t i = 0; i < kThreads; ++i)
        threads[i] = std::jthread([&, i] {
          start.arrive_and_wait();
          grids[i] = &shell.grid();
          bounds[i] = shell.max_points_in_ball(0.0005);
        });
    }
    for (std::size_t i = 0; i < kThreads; ++i) {
      EXPECT_EQ(grids[i], &shell.grid());
      EXPECT_EQ(bounds[i], max_points_in_cube(shell, 0.0005));
    }
  }
}

TEST(PointShell, LeavesItsGridToACopyThatOutlivesIt) {
  std::optional<PointShell> shell(plane_shell());
  const GridIndex& grid = shell->grid();
  const PointShell copy = *shell;
  shell.reset();
  EXPECT_EQ(&copy.grid(), &grid);
  const GridIndex expected(copy);
  ASSERT_EQ(grid.columns(), expected.columns());
  for (std::size_t i = 0; i < copy.size(); ++i) EXPECT_EQ(grid.x()[i], expected.x()[i]);
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
