#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/point_shell.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::shells_test {
namespace {

using test::cases;

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

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Returns a hole of random size. Most sizes are not a multiple of the spacing.
Hole2d random_hole(Random& random) {
  return {random.uniform(1e-4, 2e-3), random.uniform(1e-4, 1e-2), random.uniform(2e-5, 5e-4),
          random.uniform(1e-4, 4e-3)};
}
Plane random_plane(Random& random) {
  return {random.uniform(1e-4, 5e-3), random.uniform(5e-5, 5e-4)};
}
Slot random_slot(Random& random) {
  return {random.uniform(1e-4, 2e-3), random.uniform(1e-4, 4e-3), random.uniform(1e-4, 4e-3),
          random.uniform(5e-5, 5e-4)};
}

// Returns the longest allowed distance between neighbouring points: the spacing, plus a tolerance of 1e-9 of the
// spacing, plus the rounding of two coordinates of at most 1 cm.
double longest(double spacing) {
  return spacing * (1.0 + 1e-9) + 4 * kEps * 0.01;
}

template <class Surface>
void expect_counted_and_unit(const Surface& surface) {
  const auto points = surface_points(surface);
  EXPECT_EQ(static_cast<double>(points.size()), point_count(surface));
  for (const SurfacePoint& point : points) EXPECT_NEAR(point.normal.norm(), 1.0, 2 * kEps);
}

TEST(AnalyticShells, PointCountIsTheNumberOfPointsAndNormalsAreUnit) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    expect_counted_and_unit(random_hole(random));
    expect_counted_and_unit(random_plane(random));
    expect_counted_and_unit(random_slot(random));
  }
}

TEST(AnalyticShells, AMultipleOfTheSpacingButForRoundingIsDividedIntoThatMany) {
  ASSERT_GT(0.0015 / 0.0003, 5.0) << "in doubles";
  EXPECT_EQ(point_count(Plane{0.0015, 0.0003}), 6 * 6);
}

TEST(AnalyticShells, AbsurdSizesAreCountedWithoutBeingBuilt) {
  EXPECT_NEAR(point_count(Plane{1.0, 1e-12}), 1e24, 1e13);
}

TEST(Hole2dShell, FollowsTheProfileFromLeftToRightInStepsOfAtMostTheSpacing) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Hole2d hole = random_hole(random);
    const auto points = surface_points(hole);
    double length = 0.0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double step = (points[k].position - points[k - 1].position).norm();
      EXPECT_GT(step, 0.0);
      EXPECT_LE(step, longest(hole.spacing));
      length += step;
    }
    // The distances between successive points add up to the length of the profile only if the points never turn back.
    const double profile = 2 * hole.mouth + 2 * hole.depth + hole.width;
    EXPECT_NEAR(length, profile, 4 * kEps * static_cast<double>(points.size()) * profile);
    EXPECT_EQ(points.front().position, Vec3(-hole.width / 2 - hole.mouth, 0, 0));
    EXPECT_EQ(points.back().position, Vec3(hole.width / 2 + hole.mouth, 0, 0));
  }
}

TEST(Hole2dShell, EveryCornerCarriesAPointWithThe45DegreeNormalOfItsFaces) {
  const Hole2d hole{0.0011, 0.0047, 0.00013, 0.0029};
  const double half = hole.width / 2, d = std::sqrt(0.5);
  const std::vector<SurfacePoint> corners = {{{-half, 0, 0}, {d, d, 0}},
                                             {{-half, -hole.depth, 0}, {d, d, 0}},
                                             {{half, -hole.depth, 0}, {-d, d, 0}},
                                             {{half, 0, 0}, {-d, d, 0}}};
  std::size_t found = 0;
  for (const SurfacePoint& point : surface_points(hole)) {
    const double diagonal = std::abs(point.normal.x() * point.normal.y());
    if (diagonal < 0.25) continue;
    ASSERT_LT(found, corners.size());
    EXPECT_EQ(point.position, corners[found].position);
    EXPECT_LE((point.normal - corners[found].normal).norm(), 2 * kEps);
    ++found;
  }
  EXPECT_EQ(found, corners.size());
}

TEST(PlaneShell, IsASquareGridWithYFastestAndUpwardNormals) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Plane plane = random_plane(random);
    const auto points = surface_points(plane);
    const auto side = static_cast<std::size_t>(std::lround(std::sqrt(point_count(plane))));
    ASSERT_EQ(side * side, points.size());
    EXPECT_EQ(points.front().position, Vec3(-plane.size / 2, -plane.size / 2, 0));
    EXPECT_EQ(points.back().position, Vec3(plane.size / 2, plane.size / 2, 0));
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_EQ(points[k].normal, Vec3(0, 0, 1));
      EXPECT_EQ(points[k].position.x(), points[k / side * side].position.x());
      EXPECT_EQ(points[k].position.y(), points[k % side].position.y());
      if (k % side == 0) continue;
      const double step = points[k].position.y() - points[k - 1].position.y();
      EXPECT_GT(step, 0.0);
      EXPECT_LE(step, longest(plane.spacing));
    }
  }
}

TEST(ConicalHoleShell, LiesOnTheConeAndIsItsOwnQuarterTurn) {
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    const ConicalHole cone{random.uniform(0.1, 1.4), random.uniform(1e-4, 4e-3), random.uniform(2e-5, 5e-4)};
    const auto points = surface_points(cone);
    EXPECT_LE(static_cast<double>(points.size()), point_count(cone));
    EXPECT_EQ(points.front().position, Vec3(0, 0, -cone.depth));
    const double sine = std::sin(cone.half_angle), cosine = std::cos(cone.half_angle);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const Vec3& p = points[k].position;
      const double radius = std::hypot(p.x(), p.y());
      // Check the distance from the wall, up to a few roundings of lengths up to the depth over the cosine.
      EXPECT_NEAR(radius * cosine - (p.z() + cone.depth) * sine, 0.0, 8 * kEps * cone.depth / cosine);
      const Vec3 normal(-cosine * p.x() / radius, -cosine * p.y() / radius, sine);
      EXPECT_LE((points[k].normal - normal).norm(), 4 * kEps);
    }
    for (std::size_t k = 1; k + 1 < points.size(); k += 4) {
      for (std::size_t turned = k; turned < k + 3; ++turned) {
        const Vec3 &p = points[turned].position, &q = points[turned + 1].position;
        EXPECT_EQ(q, Vec3(-p.y(), p.x(), p.z()));
      }
    }
  }
}

Vec3 random_point(Random& random) {
  return {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-0.012, 0.002)};
}

TEST(BlockWithHole, DistanceChangesNoFasterThanThePointMoves) {
  const BlockWithHole block;
  Random random(11);
  for (std::size_t i = 0; i < cases(200'000); ++i) {
    const Vec3 a = random_point(random), b = a + random.uniform(0.0, 0.002) * random.direction();
    // 1e-16 is the rounding of coordinates near 0.01.
    ASSERT_LE(std::abs(signed_distance(block, a) - signed_distance(block, b)), (a - b).norm() + 1e-16);
  }
}

TEST(BlockWithHole, TheSurfaceIsAsFarAwayAsTheDistanceSaysAndTheSignIsMembership) {
  const BlockWithHole block;
  Random random(12);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < cases(20'000); ++i) {
    const Vec3 p = random_point(random);
    const double d = signed_distance(block, p);
    const double rho = std::hypot(p.x(), p.y());
    const bool material = std::abs(p.x()) < 0.0075 && std::abs(p.y()) < 0.0075 && p.z() < 0 && p.z() > -0.01 &&
                          !(rho < 0.001 && p.z() > -0.005);
    ASSERT_EQ(d < 0.0, material) << p.transpose();
    inside += material ? 1 : 0;
    // A step of length |d| against the gradient must end on the surface, because the distance is not an underestimate.
    // The gradient is a central difference over 1e-7 m. Near medial axes, it has an error of up to 1e-7 / |d| and need
    // not point away from the surface. Points whose gradient is not a unit vector are therefore left out.
    constexpr double h = 1e-7;
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = h * Vec3::Unit(k);
      gradient[k] = (signed_distance(block, p + e) - signed_distance(block, p - e)) / (2 * h);
    }
    if (std::abs(gradient.norm() - 1.0) > 1e-6) continue;
    ASSERT_NEAR(signed_distance(block, p - d * gradient), 0.0, 2e-6 * std::abs(d) + 1e-9) << p.transpose();
  }
  EXPECT_GT(inside, cases(20'000) / 4);
}

}  // namespace
}  // namespace hapbench::shells_test
