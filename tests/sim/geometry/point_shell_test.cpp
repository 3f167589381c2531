#include "sim/geometry/point_shell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/core/random.hpp"

namespace hapbench::point_shell_test {
namespace {

std::vector<SurfacePoint> random_points(Random& random, std::size_t n) {
  std::vector<SurfacePoint> points(n);
  for (SurfacePoint& point : points) point = {0.01 * random.uniform() * random.direction(), random.direction()};
  return points;
}

TEST(PointShell, IsPaddedToWholePacksWithPointsFarAway) {
  Random random(2);
  for (std::size_t n = 0; n <= 17; ++n) {
    const PointShell shell(random_points(random, n), 0.0);
    ASSERT_EQ(shell.padded_size() % 8, 0u);
    ASSERT_GE(shell.padded_size(), n);
    ASSERT_LT(shell.padded_size(), n + 8);
    for (std::size_t i = n; i < shell.padded_size(); ++i) {
      EXPECT_EQ(shell.x()[i], PointShell::kFarAway);
      EXPECT_EQ(shell.y()[i], PointShell::kFarAway);
      EXPECT_EQ(shell.z()[i], PointShell::kFarAway);
      EXPECT_EQ(Vec3(shell.nx()[i], shell.ny()[i], shell.nz()[i]), Vec3(0, 0, 0));
    }
  }
}

TEST(PointShell, TwoPointsShareACellExactlyWhenAllTheirCoordinatesDo) {
  Random random(5);
  const double size = 0.003;
  const auto points = random_points(random, 200);
  const auto cells = PointShell(points, size).cell_of_points();
  const auto cube = [size](const Vec3& p) {
    return std::array{std::floor(p.x() / size + 0.5), std::floor(p.y() / size + 0.5), std::floor(p.z() / size + 0.5)};
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_EQ(cells[i] == cells[j], cube(points[i].position) == cube(points[j].position)) << i << ", " << j;
    }
  }
}

TEST(ShellBounds, AreThoseOfThePointsWithoutThePadding) {
  const PointShell shell({{Vec3(1, 5, -2)}, {Vec3(-3, 4, 0)}, {Vec3(2, 4.5, 7)}}, 0.0);
  EXPECT_EQ(shell.bounds().min, Vec3(-3, 4, -2));
  EXPECT_EQ(shell.bounds().max, Vec3(2, 5, 7));
  EXPECT_EQ(PointShell({}, 0.0).bounds().max, Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench::point_shell_test
