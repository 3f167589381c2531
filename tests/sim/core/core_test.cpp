#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include "sim/core/hash.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench::core_test {
namespace {

// Checks values of the reference implementation (draft-eastlake-fnv, test vectors for FNV-1a, 64 bits).
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
  // The expected moments are 0, 1, 0 and 3, with the variances 1, 2, 15 and 96 divided by n. Allow five standard
  // errors.
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
    std::vector<std::pair<double, double>> values;  ///< times, and the exact value of the profile at each time
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
    // The tolerance covers the rounding errors of a few operations on numbers below 8.
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
      // Third derivatives are below 4 pi^3 = 125, so the error of the central difference is below 25 h^2 plus 1e-15 /
      // h.
      const double h = 1e-5;
      EXPECT_NEAR(profile.rate(t), (profile(t + h) - profile(t - h)) / (2.0 * h), 25 * h * h + 1e-9) << t;
    }
  }
  EXPECT_EQ(profiles[3].rate(1.0), -2.0) << "a corner belongs to the leg that begins there";
  EXPECT_EQ(profiles[3].rate(3.0), 0.0);
}

constexpr double kInf = std::numeric_limits<double>::infinity(), kNaN = std::numeric_limits<double>::quiet_NaN();

/// A function with its stated error `bound` [ulp]. Its arguments are in the range from `low` to `high`. If `powers`,
/// they have both signs and absolute values from 2^low to 2^high.
struct Case {
  const char* name;
  double (*ours)(double);
  long double (*reference)(long double);
  double bound, low, high;
  bool powers = false;
};
const Case kCases[] = {
    {"sin", math::sin, std::sin, 0.85, -10.0, 10.0},
    {"sin", math::sin, std::sin, 0.85, -1e6, 1e6},
    {"sin", math::sin, std::sin, 0.85, -1000.0, 0.0, true},
    {"cos", math::cos, std::cos, 0.85, -10.0, 10.0},
    {"cos", math::cos, std::cos, 0.85, -1e6, 1e6},
    {"tan", math::tan, std::tan, 2.5, -10.0, 10.0},
    {"asin", math::asin, std::asin, 2.5, -1.0, 1.0},
    {"asin", math::asin, std::asin, 2.5, -100.0, 0.0, true},
    {"acos", math::acos, std::acos, 2.0, -1.0, 1.0},
    {"exp", math::exp, std::exp, 0.7, -700.0, 700.0},
    {"exp", math::exp, std::exp, 0.7, -1.0, 1.0},
    {"expm1", math::expm1, std::expm1, 1.2, -40.0, 40.0},
    {"expm1", math::expm1, std::expm1, 1.2, -1.0, 1.0},
    {"expm1", math::expm1, std::expm1, 1.2, -100.0, 0.0, true},
    {"log", math::log, std::log, 1.0, 0.0, 10.0},
    {"log", math::log, std::log, 1.0, 0.999, 1.001},
    {"log", math::log, std::log, 1.0, -1074.0, 1023.0, true},
    {"log10", math::log10, std::log10, 0.51, 0.0, 10.0},
    {"log10", math::log10, std::log10, 0.51, -1074.0, 1023.0, true},
    {"atanh", math::atanh, std::atanh, 2.5, -1.0, 1.0},
    {"atanh", math::atanh, std::atanh, 2.5, -100.0, -1.0, true},
};

/// Returns the error |ours - reference| of a result of hapbench in units in the last place of the reference.
double error_in_ulp(double ours, long double reference) {
  const double size = std::abs(static_cast<double>(reference));
  return static_cast<double>(std::abs(ours - reference) / (std::nextafter(size, kInf) - size));
}

/// Returns true if long double is x87's: the reference then has 11 bits more, and its own error of one ulp is 0.0005
/// ulp of a double.
bool has_reference() {
  return std::numeric_limits<long double>::digits >= 64;
}

TEST(Math, KeepsItsStatedErrors) {
  if (!has_reference()) GTEST_SKIP() << "long double is no wider than double";
  Random random(1);
  for (const Case& c : kCases) {
    double largest = 0.0;
    for (int i = 0; i < 100'000; ++i) {
      double x = random.uniform(c.low, c.high);
      if (c.powers) x = std::exp2(x) * (random.below(2) == 0 ? 1.0 : -1.0);
      const long double expected = c.reference(x);
      if (std::isnan(expected)) {
        ASSERT_TRUE(std::isnan(c.ours(x))) << c.name << " of " << x;
        continue;
      }
      largest = std::max(largest, error_in_ulp(c.ours(x), expected));
    }
    EXPECT_LE(largest, c.bound) << c.name << " in [" << c.low << ", " << c.high << "]";
    EXPECT_GE(largest, 0.499) << c.name << ": rounding alone gives this, so the reference is not one";
  }
}

TEST(Math, OfTwoArgumentsKeepsItsStatedErrors) {
  if (!has_reference()) GTEST_SKIP() << "long double is no wider than double";
  Random random(2);
  double atan2 = 0.0, pow = 0.0, hypot = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double y = std::exp2(random.uniform(-12.0, 12.0)) * (random.below(2) == 0 ? 1.0 : -1.0);
    const double x = random.uniform(-2.0, 2.0), base = std::exp2(random.uniform(-200.0, 200.0));
    const double power = random.uniform(-5.0, 5.0);
    atan2 = std::max(atan2, error_in_ulp(math::atan2(y, x), std::atan2(static_cast<long double>(y), x)));
    pow = std::max(pow, error_in_ulp(math::pow(base, power), std::pow(static_cast<long double>(base), power)));
    hypot = std::max(hypot, error_in_ulp(math::hypot(y, x), std::hypot(static_cast<long double>(y), x)));
  }
  EXPECT_LE(atan2, 2.0);
  EXPECT_LE(pow, 0.8);
  EXPECT_LE(hypot, 1.2);
}

TEST(Math, PowersOfTenAreExact) {
  for (int n = -300; n <= 300; ++n) {
    const double power = std::stod("1e" + std::to_string(n));
    EXPECT_EQ(math::log10(power), n);
    if (n >= 0 && n <= 22) {
      EXPECT_EQ(math::pow(10.0, n), power);
    }
  }
  EXPECT_EQ(math::pow(2.0, -1074.0), 0x1p-1074);
  EXPECT_EQ(math::pow(9.0, 0.5), 3.0);
}

/// Checks large angles, which occur at long times and high frequencies. 1e-15 is the stated absolute error.
TEST(Math, LargeAnglesKeepAnAbsoluteError) {
  if (!has_reference()) GTEST_SKIP() << "long double is no wider than double";
  Random random(3);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-1e15, 1e15);
    ASSERT_NEAR(math::sin(x), static_cast<double>(std::sin(static_cast<long double>(x))), 1e-15) << x;
    ASSERT_NEAR(math::cos(x), static_cast<double>(std::cos(static_cast<long double>(x))), 1e-15) << x;
    ASSERT_LE(std::abs(math::sin(x * 1e280)), 1.0) << x;
  }
}

TEST(Math, ZerosInfinitiesAndOtherDomainsAreAsInTheStandard) {
  const double special[] = {0.0, -0.0, 1.0, -1.0, 0.5, kInf, -kInf, kNaN, 1e308, 1e-308};
  const auto same = [](double a, double b) {
    return std::isnan(a) ? std::isnan(b) : a == b && std::signbit(a) == std::signbit(b);
  };
  for (const double y : special) {
    for (const double x : special) {
      // The arguments include the ends of the range of double, where the quotient is 0, 1 or infinite. At all these
      // arguments, the function of hapbench and the function of std give the same bits.
      EXPECT_TRUE(same(math::atan2(y, x), std::atan2(y, x))) << y << " " << x;
      if (!std::isnan(x) && !std::isnan(y)) {
        EXPECT_TRUE(same(math::hypot(y, x), std::hypot(y, x)) || std::abs(y) == 1e308) << y << " " << x;
      }
    }
    EXPECT_TRUE(same(math::log(y), std::log(y)) || std::isfinite(std::log(y))) << y;
    EXPECT_TRUE(same(math::exp(y), std::exp(y)) || std::isfinite(std::exp(y))) << y;
    EXPECT_TRUE(same(math::expm1(y), std::expm1(y)) || std::isfinite(std::expm1(y))) << y;
    EXPECT_TRUE(same(math::sin(y), std::sin(y)) || std::isfinite(y)) << y;
    EXPECT_TRUE(same(math::cos(y), std::cos(y)) || std::isfinite(y)) << y;
  }
  EXPECT_TRUE(same(math::sin(-0.0), -0.0) && same(math::tan(-0.0), -0.0) && same(math::expm1(-0.0), -0.0));
  EXPECT_TRUE(same(math::pow(0.0, 2.0), 0.0) && same(math::pow(0.0, -2.0), kInf) && same(math::pow(kInf, -1.0), 0.0));
  EXPECT_TRUE(same(math::pow(2.0, 2000.0), kInf) && same(math::pow(2.0, -2000.0), 0.0) &&
              same(math::pow(0.5, -kInf), kInf));
  EXPECT_TRUE(std::isnan(math::pow(-1.0, 2.0)) && same(math::pow(3.0, 0.0), 1.0));
  EXPECT_TRUE(same(math::exp(709.0), std::exp(709.0)) && same(math::exp(-745.2), 0.0) && math::exp(-745.0) > 0.0);
  EXPECT_TRUE(same(math::atanh(1.0), kInf) && std::isnan(math::atanh(1.1)) && std::isnan(math::asin(1.1)));
}

TEST(Math, SineAndCosineTogetherAreTheSameBits) {
  Random random(5);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-100.0, 100.0);
    const auto [sine, cosine] = math::sine_cosine(x);
    ASSERT_EQ(sine, math::sin(x)) << x;
    ASSERT_EQ(cosine, math::cos(x)) << x;
  }
  EXPECT_TRUE(std::signbit(math::sine_cosine(-0.0).sine) && std::isnan(math::sine_cosine(kInf).cosine));
}

/// Checks the bits that every compiler and instruction set must give. g++ 12 for AVX-512, and clang 14 without
/// optimization for SSE2, computed the expected hash.
TEST(Math, GivesTheSameBitsEverywhere) {
  Random random(4);
  Hash64 hash;
  for (int i = 0; i < 20'000; ++i) {
    for (const Case& c : kCases) hash.real(c.ours(std::abs(random.uniform(c.low, c.high))) + 0.0);
    const double x = random.uniform(0.0, 100.0), y = random.uniform(-5.0, 5.0);
    hash.real(math::atan2(y, x));
    hash.real(math::pow(x, y));
    hash.real(math::hypot(x, y));
  }
  EXPECT_EQ(hash.value(), 2380389850883370860u);
}

}  // namespace
}  // namespace hapbench::core_test
