#include "device_model/hands/drag_hand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/geometry/analytic_shells.hpp"

namespace hapbench::drag_hand_test {
namespace {

constexpr double kSmoothing = 0.0005;

/// A plane and paths over it.
class DragOnPlane : public testing::Test {
 protected:
  std::shared_ptr<const SurfacePath> over(std::vector<Vec3> points) const {
    return std::make_shared<const SurfacePath>(SurfacePath::over(surface_, points));
  }
  std::shared_ptr<const SurfacePath> along(const Vec3& start, const Vec3& direction, double length) const {
    return std::make_shared<const SurfacePath>(SurfacePath::along(surface_, start, direction, length));
  }

  const PointShell shell_{surface_points(Plane{0.004, 0.0001}), 0.0001};
  const SmoothedSurface surface_{shell_, kSmoothing};
};

TEST_F(DragOnPlane, PathGoesThroughItsPointsBelowThem) {
  const auto path = over({{-0.001, 0, 0.0003}, {0.001, 0, 0.0003}, {0.001, 0.001, -0.0002}});
  EXPECT_NEAR(path->length(), 0.003, 1e-15);
  EXPECT_NEAR((path->at(0.0).position - Vec3(-0.001, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((path->at(0.00123).position - Vec3(0.00023, 0, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((path->at(0.0027).position - Vec3(0.001, 0.0007, 0)).norm(), 0.0, 1e-15);
  EXPECT_EQ(path->at(1.0).position, path->at(path->length()).position);
  EXPECT_EQ(path->at(-1.0).position, path->at(0.0).position);
}

TEST_F(DragOnPlane, DirectionTurnsSteadilyAroundACorner) {
  const auto path = over({{-0.001, 0, 0}, {0.001, 0, 0}, {0.001, 0.001, 0}});
  EXPECT_NEAR((path->direction(0.001) - Vec3(1, 0, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((path->direction(0.002) - Vec3(1, 1, 0).normalized()).norm(), 0.0, 1e-9);
  EXPECT_NEAR((path->direction(0.0027) - Vec3(0, 1, 0)).norm(), 0.0, 1e-12);
}

TEST_F(DragOnPlane, PathAlongADirectionEndsAtTheEdge) {
  const auto path = along({0.001, 0, 0.002}, {2, 0, -5}, 1.0);
  // Places beyond the last points are still in their plane as long as some point is within the smoothing radius.
  EXPECT_GT(path->length(), 0.001 - 1e-12);
  EXPECT_LT(path->length(), 0.001 + kSmoothing);
  EXPECT_NEAR(path->at(0.0005).position.x(), 0.0015, 1e-12);
  EXPECT_NEAR(along({0, 0, 0}, {1, 0, 0}, 0.001)->length(), 0.001, 1.01 * SurfacePath::spacing(kSmoothing));
  EXPECT_EQ(along({0, 0, 0}, {0, 0, 1}, 0.001)->length(), 0.0) << "no way on along the normal";
}

TEST(SurfacePath, AlongADirectionStartsFromFarAboveARoughSurface) {
  // Waves of 0.1 mm, shorter than the smoothing radius: seen from 2 mm above, the first place lies off the surface.
  constexpr double kWave = 2.0 * std::numbers::pi / 0.0003, kHeight = 0.0001;
  std::vector<SurfacePoint> points;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const double x = 5e-5 * i, y = 5e-5 * j;
      const Vec3 normal(-kHeight * kWave * std::cos(kWave * x), -kHeight * kWave * std::cos(kWave * y), 1.0);
      const double z = kHeight * (std::sin(kWave * x) + std::sin(kWave * y));
      points.push_back({Vec3(x, y, z), normal.normalized()});
    }
  }
  const PointShell shell(points, 0.0);
  const SmoothedSurface surface(shell, kSmoothing);
  for (int i = -3; i <= 3; ++i)
    EXPECT_GT(SurfacePath::along(surface, {1e-4 * i, 1e-4, 0.002}, {1, 0, 0}, 0.001).length(), 0.0009) << i;
}

TEST_F(DragOnPlane, PushesAlongTheNormalAndPullsWithinTheSurface) {
  const Drag drag{.force = 2.0, .speed = 0.01, .stiffness = 100.0, .damping = 10.0, .normal_damping = 50.0};
  DragHand hand(drag, over({{-0.001, 0, 0}, {0.001, 0, 0}}));
  const Vec3 x(-0.0004, 0.0002, 0.0005), v(0.003, -0.001, -0.02);
  // At t = 0.05 s the moving point is at x = -0.5 mm.
  const Vec3 expected(100.0 * -0.0001 + 10.0 * (0.01 - 0.003), 100.0 * -0.0002 + 10.0 * 0.001, -2.0 + 50.0 * 0.02);
  EXPECT_LT((hand.force(0.05, {{x, v}, {}, {}}) - expected).norm(), 1e-12);
  // Once the path is at its end, the point rests.
  EXPECT_LT((hand.force(1.0, {{{0.001, 0, 0.0005}, {0, 0, 0}}, {}, {}}) - Vec3(0, 0, -2)).norm(), 1e-12);
}

TEST_F(DragOnPlane, ForcesDoNotDependOnWhatIsRendered) {
  DragHand a({}, over({{-0.001, 0, 0}, {0.001, 0, 0}})), b({}, over({{-0.001, 0, 0}, {0.001, 0, 0}}));
  const HandleState handle{{0.0001, 0, 0.0002}, {0.01, 0, 0}};
  EXPECT_EQ(a.force(0.1, {handle, {}, {0, 0, 0}, {0, 0, 0}}), b.force(0.1, {handle, {}, {9, 9, 9}, {-9, 9, 9}}));
}

TEST_F(DragOnPlane, AxisLeansFromTheNormalTowardsTheTravel) {
  const auto path = over({{-0.001, 0, 0}, {0.001, 0, 0}});
  const auto axis = [&](double tilt, double azimuth) {
    return DragOrientation(path, 0.01, tilt, azimuth).axis_at(0.1);
  };
  EXPECT_LT((axis(0.0, 0.0) - Vec3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((axis(0.3, 0.0) - Vec3(-std::sin(0.3), 0, -std::cos(0.3))).norm(), 1e-12);
  // A quarter turn about the normal, right-handed: to the left of the travel.
  EXPECT_LT((axis(0.3, std::acos(0.0)) - Vec3(0, -std::sin(0.3), -std::cos(0.3))).norm(), 1e-12);
}

TEST(DragHand, PushesAlongTheNormalOfASphereWhereTheHandleIs) {
  constexpr double kRadius = 0.005;
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 20'000; ++i) {  // evenly, on a spiral of golden angles
    const double z = 1.0 - (2.0 * i + 1.0) / 20'000, rho = std::sqrt(1.0 - z * z), turn = 2.399963229728653 * i;
    const Vec3 normal(rho * std::cos(turn), rho * std::sin(turn), z);
    points.push_back({kRadius * normal, normal});
  }
  const PointShell shell(points, 0.0);
  const SmoothedSurface surface(shell, kSmoothing);
  DragHand hand({.force = 1.0, .stiffness = 0.0, .damping = 0.0},
                std::make_shared<const SurfacePath>(SurfacePath::along(surface, {-0.004, 0, 0.003}, {1, 0, 0}, 0.02)));
  // From 53 degrees on one side of the top to 60 on the other, a tool's radius above, as slowly as a hand moves.
  for (double angle = -0.92; angle < 1.05; angle += 0.001) {
    // Up to two smoothing radii aside of the path, where the surface is bent as much.
    const double aside = 0.18 * std::sin(20.0 * angle);
    const Vec3 radial(std::sin(angle) * std::cos(aside), std::sin(aside), std::cos(angle) * std::cos(aside));
    const Vec3 force = hand.force(0.0, {{(kRadius + 0.0005) * radial, Vec3::Zero()}, {}, {}});
    EXPECT_NEAR(force.norm(), 1.0, 1e-12);
    // The mean of normals within R of a place is no further off than R / r; the place lags by two steps, 0.002; and an
    // arc of 0.18, 1 mm aside at the handle's height, is 0.194 in the table, whose steps lie in the path's plane.
    EXPECT_LT(std::acos(std::min(1.0, -force.dot(radial))), kSmoothing / kRadius + 0.016) << angle;
  }
}

}  // namespace
}  // namespace hapbench::drag_hand_test
