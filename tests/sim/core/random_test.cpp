#include "sim/core/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace hapbench::random_test {
namespace {

TEST(Random, UniformIsTheTop53BitsOfMt19937_64) {
  // The standard ([rand.predef]) fixes the 10000th number of the default seed 5489.
  Random random(5489);
  for (int i = 1; i < 10000; ++i) random.uniform();
  EXPECT_EQ(random.uniform(), static_cast<double>(9981545732273789042u >> 11) * 0x1.0p-53);
}

TEST(Random, SameSeedGivesSameNumbers) {
  Random a(7), b(7), c(8);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double x = a.uniform();
    EXPECT_EQ(x, b.uniform());
    differs |= x != c.uniform();
  }
  EXPECT_TRUE(differs);
}

TEST(Random, NumbersStayInTheirRange) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-3.0, 5.0);
    ASSERT_GE(x, -3.0);
    ASSERT_LT(x, 5.0);
    ASSERT_LT(random.below(7), 7u);
  }
}

TEST(Random, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
  Random random(4);
  constexpr int n = 200'000;
  std::array<double, 5> moments{};
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    for (std::size_t k = 1; k < moments.size(); ++k) moments[k] += std::pow(x, static_cast<double>(k)) / n;
  }
  // Expected 0, 1, 0, 3 with variances 1, 2, 15, 96 over n; five standard errors.
  const double root = std::sqrt(n);
  EXPECT_NEAR(moments[1], 0.0, 5 * 1.0 / root);
  EXPECT_NEAR(moments[2], 1.0, 5 * std::sqrt(2.0) / root);
  EXPECT_NEAR(moments[3], 0.0, 5 * std::sqrt(15.0) / root);
  EXPECT_NEAR(moments[4], 3.0, 5 * std::sqrt(96.0) / root);
}

TEST(Random, DerivesSeedsThatDifferForNeighboursOfBothKinds) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t stream = 0; stream < 100; ++stream) {
    for (std::uint64_t number = 0; number < 100; ++number) seeds.insert(Random::derive(stream, number));
  }
  EXPECT_EQ(seeds.size(), 10'000u);
  static_assert(Random::derive(3, 5) == 3 * 0x9e3779b97f4a7c15u + 5, "results depend on it");
}

TEST(Random, DirectionsAreUnitVectors) {
  Random random(2);
  // Three rounded squares and a rounded root.
  const double tolerance = 4 * std::numeric_limits<double>::epsilon();
  for (int i = 0; i < 10000; ++i) {
    ASSERT_NEAR(random.direction().norm(), 1.0, tolerance);
    const Vec3 planar = random.direction_in_plane();
    ASSERT_NEAR(planar.norm(), 1.0, tolerance);
    ASSERT_EQ(planar.z(), 0.0);
  }
}

TEST(Random, DirectionsFavourNoOctant) {
  Random random(3);
  constexpr int n = 80000;
  std::array<int, 8> octants{};
  for (int i = 0; i < n; ++i) {
    const Vec3 u = random.direction();
    ++octants[(u.x() > 0) + 2u * (u.y() > 0) + 4u * (u.z() > 0)];
  }
  // Binomial with p = 1/8: standard deviation 94; six of them.
  for (const int count : octants) EXPECT_NEAR(count, n / 8, 6 * 94);
}

}  // namespace
}  // namespace hapbench::random_test
