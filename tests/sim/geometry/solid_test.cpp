#include "sim/geometry/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/core/random.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::solid_test {
namespace {

Vec3 random_point(Random& random, double half) {
  return half * Vec3(2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0);
}

std::unique_ptr<const Solid> solid_of(const TriangleSoup& soup) {
  return make_solid(soup.vertices, soup.triangles);
}

TEST(Solid, BelowAPlaneIsTheDepthAtAnyDepth) {
  const auto plane = make_solid(Plane{0.01, 0.0001});
  for (const double z : {1.0, 1e-6, -1e-6, -0.5}) {
    EXPECT_EQ(plane->at({0.004, -0.004, z}).value, z);
    EXPECT_TRUE(plane->at({0.004, -0.004, z}).known);
    EXPECT_FALSE(plane->at({0.006, 0.0, z}).known) << "beside the square";
  }
}

/// The distance to points close together on the surface, with their spacing as the tolerance: the least distance to a
/// surface of dense points is at most half a diagonal of their squares too large.
template <class Shape>
void expect_distances_to_points(Shape shape, double reach, bool planar) {
  const auto solid = make_solid(shape);
  const std::vector<SurfacePoint> points = surface_points(shape);
  Random random(3);
  int inside = 0;
  for (int i = 0; i < 300; ++i) {
    Vec3 q = random_point(random, reach);
    if (planar) q.z() = 0.0;
    const SurfaceDistance phi = solid->at(q);
    if (!phi.known) continue;
    double nearest = 1e9;
    const SurfacePoint* point = nullptr;
    for (const SurfacePoint& p : points) {
      if ((p.position - q).norm() >= nearest) continue;
      nearest = (p.position - q).norm();
      point = &p;
    }
    EXPECT_LE(std::abs(phi.value), nearest + 1e-12);
    EXPECT_GE(std::abs(phi.value), nearest - 0.75 * shape.spacing) << q.transpose();
    // Off an edge the sign is that of its mean normal, too.
    if (nearest > 2.0 * shape.spacing) {
      EXPECT_EQ(phi.value > 0.0, point->normal.dot(q - point->position) > 0.0) << q.transpose();
    }
    inside += phi.value < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 20);
}

TEST(Solid, OfAnalyticScenesHasTheDistanceToTheirPoints) {
  expect_distances_to_points(Slot{0.001, 0.005, 0.01, 0.0001}, 0.004, false);
  expect_distances_to_points(Hole2d{0.001, 0.005, 0.00005, 0.004}, 0.004, true);
  expect_distances_to_points(ConicalHole{0.5, 0.003, 0.00004}, 0.0016, false);
}

Vec3 test_gradient(const TriangleSoup& soup, const Vec3& q) {
  constexpr double kStep = 1e-8;
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    const Vec3 aside = kStep * Vec3::Unit(k);
    gradient[k] = test::exact_distance(soup, q + aside) - test::exact_distance(soup, q - aside);
  }
  return gradient.normalized();
}

TEST(Solid, OfAClosedMeshHasItsExactDistance) {
  const TriangleSoup box = test::cube(0.005, {0.001, 0.0, 0.0}), cup = test::scaled(test::cup(24), 0.003);
  for (const TriangleSoup* soup : {&box, &cup}) {
    const auto solid = solid_of(*soup);
    Random random(4);
    for (int i = 0; i < 300; ++i) {
      const Vec3 q = random_point(random, 0.01);
      EXPECT_NEAR(solid->at(q).value, test::exact_distance(*soup, q), 1e-12) << q.transpose();
      const LookedUp near{q + random_point(random, 0.002), 0.0};
      const LookedUp looked{near.place, solid->at(near.place).value};
      EXPECT_EQ(solid->at(q, &looked).value, solid->at(q).value);
      EXPECT_NEAR(solid->gradient(q, 1e-6).dot(test_gradient(*soup, q)), 1.0, 1e-6) << q.transpose();
      EXPECT_TRUE(solid->at(q).known);
    }
    // A line along edges and through vertices crosses the surface as one beside it.
    EXPECT_NEAR(solid->at(soup->vertices[0] - Vec3(0, 0, 1)).value,
                test::exact_distance(*soup, soup->vertices[0] - Vec3(0, 0, 1)), 1e-12);
  }
  EXPECT_NEAR(solid_of(test::cube())->at({0, 0, 0}).value, -1.0, 1e-15);
}

TEST(Solid, OfPartsThatOverlapIsInsideInBoth) {
  const auto solid = solid_of(test::together(test::cube(1.0), test::cube(1.0, {0.7, 0.0, 0.0})));
  for (double x = -0.95; x < 1.7; x += 0.05) EXPECT_LT(solid->at({x, 0.1, 0.2}).value, 0.0) << x;
  EXPECT_GT(solid->at({1.75, 0.1, 0.2}).value, 0.0);
}

TEST(Solid, OfAnOpenSheetIsUnknownBeyondItsBorder) {
  const auto solid = solid_of(test::sheet(10, 10, [](int i, int j) { return Vec3(0.001 * i, 0.001 * j, 0.0); }));
  const double up = solid->at({0.005, 0.005, 0.001}).value;  // the sheet's winding decides
  EXPECT_NEAR(std::abs(up), 0.001, 1e-15);
  for (const double z : {0.02, -0.02}) {
    EXPECT_NEAR(solid->at({0.0052, 0.0047, z}).value, std::copysign(1.0, up) * z, 1e-15);
    EXPECT_TRUE(solid->at({0.0052, 0.0047, z}).known);
    EXPECT_FALSE(solid->at({0.0102, 0.005, z}).known);
    EXPECT_FALSE(solid->at({-0.001, -0.002, z}).known);
  }
}

TEST(Solid, OfPointsIsThatOfTheirPlanesAndUnknownBeyondThem) {
  std::vector<SurfacePoint> points;
  Random random(5);
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const Vec3 shift = random_point(random, 0.00003);
      points.push_back({{0.0001 * i + shift.x(), 0.0001 * j + shift.y(), 0.0}, Vec3::UnitZ()});
    }
  }
  const auto solid = make_solid(points);
  for (const double z : {0.003, 0.00001, -0.00001, -0.02}) {
    for (double x = 0.0002; x < 0.0037; x += 0.00013) {
      EXPECT_NEAR(solid->at({x, 0.002, z}).value, z, 1e-15);
      EXPECT_TRUE(solid->at({x, 0.002, z}).known);
    }
    EXPECT_FALSE(solid->at({0.0045, 0.002, z}).known) << z;
    EXPECT_FALSE(solid->at({0.01, -0.01, z}).known) << z;
  }
}

}  // namespace
}  // namespace hapbench::solid_test
