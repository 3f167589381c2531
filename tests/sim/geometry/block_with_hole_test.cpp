#include "sim/geometry/analytic_shells.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/core/random.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::block_with_hole_test {
namespace {

using test::cases;

Vec3 random_point(Random& random) {
  return {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-0.012, 0.002)};
}

TEST(BlockWithHole, DistanceIsKnownAtPlacesThatShowEveryPieceOfTheSurface) {
  const BlockWithHole block;
  // Exact but for the rounding of one square root of numbers near 0.01.
  constexpr double tolerance = 1e-17;
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, -0.0025}), 0.001, tolerance);   // hole: to the wall
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, -0.0049}), 0.0001, tolerance);  // hole: to its bottom
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, 0.0}), 0.001, tolerance);       // mouth: to the rim
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, 0.002}), std::hypot(0.002, 0.001), tolerance);
  EXPECT_NEAR(signed_distance(block, {0.004, 0.0, 0.0003}), 0.0003, tolerance);    // above the top face
  EXPECT_NEAR(signed_distance(block, {0.004, 0.0, -0.0003}), -0.0003, tolerance);  // below it, in the material
  EXPECT_NEAR(signed_distance(block, {0.0012, 0.0, -0.002}), -0.0002, tolerance);  // behind the wall
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, -0.0052}), -0.0002, tolerance);    // under the hole
  EXPECT_NEAR(signed_distance(block, {0.0085, 0.0, -0.005}), 0.001, tolerance);    // beside the block
  EXPECT_NEAR(signed_distance(block, {0.0105, 0.0, 0.004}), std::hypot(0.003, 0.004), tolerance);  // off an edge
  EXPECT_NEAR(signed_distance(block, {0.0, 0.0, -0.012}), 0.002, tolerance);                       // under the block
}

TEST(BlockWithHole, DistanceChangesNoFasterThanThePointMoves) {
  const BlockWithHole block;
  Random random(11);
  for (std::size_t i = 0; i < cases(200'000); ++i) {
    const Vec3 a = random_point(random), b = a + random.uniform(0.0, 0.002) * random.direction();
    // Rounding of coordinates near 0.01.
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
    // Walking down the gradient by |d| must end on the surface: the distance is not an underestimate. The gradient is a
    // central difference over 1e-7 m, off by up to 1e-7 / |d| near medial axes, where it may fail: there the surface is
    // reached in another direction, so points with a gradient that is not unit are left out.
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
}  // namespace hapbench::block_with_hole_test
