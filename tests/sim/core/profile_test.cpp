#include "sim/core/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hapbench::profile_test {
namespace {

using Waypoints = Profile::Waypoints;
constexpr auto kLinear = Profile::Interpolation::linear;
constexpr auto kCosine = Profile::Interpolation::cosine;

TEST(Profile, IsZeroByDefault) {
  EXPECT_EQ(Profile()(0.0), 0.0);
  EXPECT_EQ(Profile()(123.0), 0.0);
}

TEST(Profile, ConstantHasOneValueAtAllTimes) {
  const Profile profile = -2.5;
  for (const double t : {-1e9, 0.0, 0.3, 1e9}) EXPECT_EQ(profile(t), -2.5);
}

TEST(Profile, RampStartsAtItsStartAndGrowsAtItsRate) {
  const Profile profile = Profile::Shape(Profile::Ramp{0.5, -2.0});
  EXPECT_EQ(profile(0.0), 0.5);
  EXPECT_EQ(profile(0.25), 0.0);
  EXPECT_EQ(profile(3.0), -5.5);
  EXPECT_EQ(profile(-1.0), 2.5);
}

TEST(Profile, SineHasItsMeanAmplitudePeriodAndPhase) {
  const Profile profile = Profile::Shape(Profile::Sine{1.0, 3.0, 0.5, 0.0});
  // One rounding in 2 pi t / T times a slope of at most the amplitude, one in the sine, one in the sum.
  const double tolerance = 16 * std::numeric_limits<double>::epsilon();
  EXPECT_EQ(profile(0.0), 1.0);
  EXPECT_NEAR(profile(0.125), 4.0, tolerance);
  EXPECT_NEAR(profile(0.25), 1.0, tolerance);
  EXPECT_NEAR(profile(0.375), -2.0, tolerance);
  EXPECT_NEAR(profile(0.5 + 0.1), profile(0.1), 4 * tolerance);

  const Profile shifted = Profile::Shape(Profile::Sine{1.0, 3.0, 0.5, std::numbers::pi / 2});
  EXPECT_NEAR(shifted(0.0), 4.0, tolerance);
  EXPECT_NEAR(shifted(0.125), 1.0, tolerance);
}

TEST(Profile, WaypointsPassThroughEveryPointExactly) {
  for (const auto interpolation : {kLinear, kCosine}) {
    const Profile profile = Profile::Shape(Waypoints{{{0.1, 1.0}, {0.3, -7.0}, {0.35, 0.1}}, interpolation});
    EXPECT_EQ(profile(0.1), 1.0);
    EXPECT_EQ(profile(0.3), -7.0);
    EXPECT_EQ(profile(0.35), 0.1);
  }
}

TEST(Profile, WaypointsAreHeldConstantOutside) {
  for (const auto interpolation : {kLinear, kCosine}) {
    const Profile profile = Profile::Shape(Waypoints{{{1.0, 4.0}, {2.0, -3.0}}, interpolation});
    for (const double t : {-1e300, 0.0, 0.999999}) EXPECT_EQ(profile(t), 4.0);
    for (const double t : {2.000001, 3.0, 1e300}) EXPECT_EQ(profile(t), -3.0);
  }
}

TEST(Profile, LinearWaypointsAreStraightBetweenPoints) {
  // Powers of two, so that the quarter points are exact.
  const Profile profile = Profile::Shape(Waypoints{{{0.0, 0.0}, {1.0, 8.0}, {3.0, 4.0}}, kLinear});
  EXPECT_EQ(profile(0.25), 2.0);
  EXPECT_EQ(profile(0.5), 4.0);
  EXPECT_EQ(profile(1.5), 7.0);
  EXPECT_EQ(profile(2.5), 5.0);
}

TEST(Profile, CosineWaypointsFollowHalfACosineOnEachLeg) {
  const Profile profile = Profile::Shape(Waypoints{{{2.0, 1.0}, {4.0, 5.0}}, kCosine});
  for (int k = 0; k <= 20; ++k) {
    const double s = k / 20.0;
    // A leg of length 4 evaluated in a handful of operations on numbers below 8.
    EXPECT_NEAR(profile(2.0 + 2.0 * s), 3.0 - 2.0 * std::cos(std::numbers::pi * s), 1e-14) << s;
  }
}

TEST(Profile, CosineWaypointsStartAndEndEachLegAtRest) {
  const Profile profile = Profile::Shape(Waypoints{{{0.0, 0.0}, {1.0, 1.0}, {2.0, -3.0}}, kCosine});
  // The curvature of a leg of height h is at most pi^2 h / 2 < 20, so a step e from rest moves by less than 10 e^2.
  const double e = 1e-4;
  for (const double t : {0.0, 1.0, 2.0}) {
    EXPECT_NEAR(profile(t + e), profile(t), 10 * e * e) << t;
    EXPECT_NEAR(profile(t - e), profile(t), 10 * e * e) << t;
  }
}

TEST(Profile, ASingleWaypointIsAConstant) {
  const Profile profile = Profile::Shape(Waypoints{{{1.0, 4.0}}, kLinear});
  for (const double t : {0.0, 1.0, 2.0}) EXPECT_EQ(profile(t), 4.0);
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

TEST(Profile, KeepsTheShapeItWasGiven) {
  const Profile profile = Profile::Shape(Profile::Ramp{0.5, -2.0});
  ASSERT_TRUE(std::holds_alternative<Profile::Ramp>(profile.shape()));
  EXPECT_EQ(std::get<Profile::Ramp>(profile.shape()).rate_per_s, -2.0);
  EXPECT_EQ(std::get<Profile::Constant>(Profile(3.0).shape()).value, 3.0);
}

}  // namespace
}  // namespace hapbench::profile_test
