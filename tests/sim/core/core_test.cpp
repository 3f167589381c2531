#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "sim/core/hash.hpp"
#include "sim/core/profile.hpp"
#include "sim/core/random.hpp"

namespace hapbench::core_test {
namespace {

// Values of the reference implementation (draft-eastlake-fnv, test vectors for FNV-1a, 64 bits).
TEST(Hash, OfTextEqualsPublishedVectorsOfFnv1a) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325u);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8u);
}

TEST(Hash, TextHasSixteenHexadecimalDigitsLeadingZerosIncluded) {
  EXPECT_EQ(hash_text(0x00f1e2d3c4b5a697u), "00f1e2d3c4b5a697");
  EXPECT_EQ(hash_text(0), "0000000000000000");
}

TEST(Random, UniformIsTheTop53BitsOfMt19937_64) {
  // The standard ([rand.predef]) fixes the 10000th number of the default seed 5489.
  Random random(5489);
  for (int i = 1; i < 10000; ++i) random.uniform();
  EXPECT_EQ(random.uniform(), static_cast<double>(9981545732273789042u >> 11) * 0x1.0p-53);
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

using Waypoints = Profile::Waypoints;
constexpr auto kLinear = Profile::Interpolation::linear;
constexpr auto kCosine = Profile::Interpolation::cosine;

TEST(Profile, HasTheValuesOfItsShape) {
  const Profile linear = Profile::Shape(Waypoints{{{0.1, 1.0}, {0.3, -7.0}, {0.35, 0.1}}, kLinear});
  const Profile cosine = Profile::Shape(Waypoints{{{0.1, 1.0}, {0.3, -7.0}, {0.35, 0.1}}, kCosine});
  const Profile straight = Profile::Shape(Waypoints{{{0.0, 0.0}, {1.0, 8.0}, {3.0, 4.0}}, kLinear});
  const struct {
    const char* name;
    Profile profile;
    std::vector<std::pair<double, double>> values;  ///< exact: at the time, the value
  } kCases[] = {
      {"zero by default", {}, {{0.0, 0.0}, {123.0, 0.0}}},
      {"constant", -2.5, {{-1e9, -2.5}, {0.0, -2.5}, {0.3, -2.5}, {1e9, -2.5}}},
      {"ramp", Profile::Shape(Profile::Ramp{0.5, -2.0}), {{0.0, 0.5}, {0.25, 0.0}, {3.0, -5.5}, {-1.0, 2.5}}},
      {"sine", Profile::Shape(Profile::Sine{1.0, 3.0, 0.5, 0.0}), {{0.0, 1.0}}},
      {"through every linear waypoint", linear, {{0.1, 1.0}, {0.3, -7.0}, {0.35, 0.1}}},
      {"through every cosine waypoint", cosine, {{0.1, 1.0}, {0.3, -7.0}, {0.35, 0.1}}},
      {"linear, held outside", linear, {{-1e300, 1.0}, {0.0999, 1.0}, {0.3501, 0.1}, {1e300, 0.1}}},
      {"cosine, held outside", cosine, {{-1e300, 1.0}, {0.0999, 1.0}, {0.3501, 0.1}, {1e300, 0.1}}},
      {"straight between", straight, {{0.25, 2.0}, {0.5, 4.0}, {1.5, 7.0}, {2.5, 5.0}}},
      {"one waypoint", Profile::Shape(Waypoints{{{1.0, 4.0}}, kLinear}), {{0.0, 4.0}, {1.0, 4.0}, {2.0, 4.0}}}};
  for (const auto& [name, profile, values] : kCases) {
    for (const auto& [t, value] : values) EXPECT_EQ(profile(t), value) << name << " at " << t;
  }
}

TEST(Profile, CosineWaypointsFollowHalfACosineOnEachLeg) {
  const Profile profile = Profile::Shape(Waypoints{{{2.0, 1.0}, {4.0, 5.0}}, kCosine});
  for (int k = 0; k <= 20; ++k) {
    const double s = k / 20.0;
    // A leg of length 4 evaluated in a handful of operations on numbers below 8.
    EXPECT_NEAR(profile(2.0 + 2.0 * s), 3.0 - 2.0 * std::cos(std::numbers::pi * s), 1e-14) << s;
  }
}

TEST(Profile, RateIsTheTimeDerivativeOfEveryShape) {
  const Profile profiles[] = {3.0, Profile::Shape(Profile::Ramp{1.0, -2.0}),
                              Profile::Shape(Profile::Sine{1.0, 2.0, 3.0, 0.5}),
                              Profile::Shape(Waypoints{{{0.0, 0.0}, {1.0, 8.0}, {3.0, 4.0}}, kLinear}),
                              Profile::Shape(Waypoints{{{0.0, 0.0}, {1.0, 8.0}, {3.0, 4.0}}, kCosine})};
  for (const Profile& profile : profiles) {
    for (const double t : {-1.0, 0.3, 0.7, 1.4, 2.2, 5.0}) {
      // Third derivatives stay below 4 pi^3 = 125: the central difference errs by less than 25 h^2 and 1e-15 / h.
      const double h = 1e-5;
      EXPECT_NEAR(profile.rate(t), (profile(t + h) - profile(t - h)) / (2.0 * h), 25 * h * h + 1e-9) << t;
    }
  }
  EXPECT_EQ(profiles[3].rate(1.0), -2.0) << "a corner belongs to the leg that begins there";
  EXPECT_EQ(profiles[3].rate(3.0), 0.0);
}

}  // namespace
}  // namespace hapbench::core_test
