#include "device_model/hands/drag_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/core/random.hpp"
#include "sim/geometry/analytic_shells.hpp"

namespace hapbench::smoothed_surface_test {
namespace {

/// Points spread evenly over a sphere about the origin, on a spiral of golden angles.
std::vector<SurfacePoint> sphere(double radius, int count) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, turn = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double rho = std::sqrt(1.0 - z * z);
    const Vec3 normal(rho * std::cos(turn), rho * std::sin(turn), z);
    points.push_back({radius * normal, normal});
  }
  return points;
}

TEST(SmoothedSurface, OfAPlaneIsThePlane) {
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0001);
  const SmoothedSurface surface(shell, 0.0005);
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vec3 at = 0.002 * random.direction();
    const SurfacePoint place = surface.nearest(at);
    // All points have z = 0 and one normal, so the averages are exact but for the division of equal sums.
    EXPECT_LT((place.normal - Vec3(0, 0, 1)).norm(), 1e-15);
    EXPECT_LT((place.position - Vec3(at.x(), at.y(), 0)).norm(), 1e-18) << at.transpose();
  }
}

TEST(SmoothedSurface, OfASphereFollowsIt) {
  constexpr double kRadius = 0.005, kSmoothing = 0.0005;
  const PointShell shell(sphere(kRadius, 20'000), 0.0);
  const SmoothedSurface surface(shell, kSmoothing);
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 radial = random.direction();
    const SurfacePoint place = surface.nearest((kRadius + 0.001 * random.uniform()) * radial);
    // Neighbours lie within R of a place near the sphere, so no normal among them, and no mean of them, is further
    // off than the angle 2 asin(R / 2r); and their centre is no deeper than the sagitta of R.
    EXPECT_LT(std::acos(std::min(1.0, place.normal.dot(radial))), 2.0 * std::asin(kSmoothing / (2.0 * kRadius)));
    EXPECT_NEAR(place.position.norm(), kRadius, kSmoothing * kSmoothing / (2.0 * kRadius));
  }
}

TEST(SmoothedSurface, DoesNotSeeTheFarSideOfAThinWall) {
  std::vector<SurfacePoint> points = surface_points(Plane{0.004, 0.0001});
  for (std::size_t i = 0, n = points.size(); i < n; ++i)
    points.push_back({points[i].position - Vec3(0, 0, 0.0001), {0, 0, -1}});
  const PointShell shell(points, 0.0001);
  const SurfacePoint place = SmoothedSurface(shell, 0.0005).nearest({0.0003, 0.0002, 0.0001});
  EXPECT_LT((place.normal - Vec3(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT(std::abs(place.position.z()), 1e-18);
}

TEST(SmoothedSurface, EndsWithTheShell) {
  const PointShell shell(surface_points(Plane{0.004, 0.0001}), 0.0001);
  const SmoothedSurface surface(shell, 0.0005);
  EXPECT_LT((surface.nearest({0.9, 0, 0.3}).position - Vec3(0.002, 0, 0)).norm(), 1e-15);
  // Within the radius the last points are the plane's neighbours still.
  EXPECT_LT((surface.nearest({0.0024, 0, 0.0001}).position - Vec3(0.0024, 0, 0)).norm(), 1e-15);
}

}  // namespace
}  // namespace hapbench::smoothed_surface_test
