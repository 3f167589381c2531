#include "device_model/velocity_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/core/random.hpp"

namespace hapbench::velocity_filter_test {
namespace {

constexpr double kStep = 0.001;

TEST(VelocityFilter, DifferenceIsThatOfTheLastTwoSamples) {
  VelocityFilter filter(DifferenceFilter{}, kStep);
  filter.reset({1, 1, 1});
  EXPECT_EQ(filter.read({1.5, 1, 0}), Vec3((1.5 - 1) / kStep, 0, (0 - 1) / kStep));
  EXPECT_EQ(filter.read({1.5, 1, 0}), Vec3(0, 0, 0));
}

/// Of a velocity that steps from 0 to 1 the continuous low-pass makes 1 - e^(-2 pi f t); so does the sampled one.
TEST(VelocityFilter, LowPassAnswersAStepLikeTheContinuousOne) {
  constexpr double kCutoff = 30.0;
  VelocityFilter filter(LowPassFilter{kCutoff}, kStep);
  filter.reset(Vec3::Zero());
  for (int k = 1; k <= 100; ++k) {
    const double t = k * kStep;
    EXPECT_NEAR(filter.read({t, 0, -t}).x(), -std::expm1(-2.0 * std::numbers::pi * kCutoff * t), 1e-12);
  }
}

TEST(VelocityFilter, ALowPassAboveAllFrequenciesIsTheDifference) {
  VelocityFilter low_pass(LowPassFilter{1e9}, kStep), difference(DifferenceFilter{}, kStep);
  low_pass.reset(Vec3::Zero());
  difference.reset(Vec3::Zero());
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    const Vec3 x(random.normal(), random.normal(), random.normal());
    EXPECT_EQ(low_pass.read(x), difference.read(x));
  }
}

/// The definition, on all samples at once: the longest window, grown from 1, of which every sample lies on the line
/// through its ends, give or take the noise.
double longest_line(const std::vector<double>& x, double noise) {
  const std::size_t k = x.size() - 1;
  double slope = 0.0;
  for (std::size_t n = 1; n <= std::min<std::size_t>(k, 15); ++n) {
    for (std::size_t j = k - n; j <= k; ++j) {
      const double line = x[k - n] + (x[k] - x[k - n]) * static_cast<double>(j - (k - n)) / static_cast<double>(n);
      if (std::abs(line - x[j]) > noise + 1e-15) return slope;
    }
    slope = (x[k] - x[k - n]) / (static_cast<double>(n) * kStep);
  }
  return slope;
}

TEST(VelocityFilter, AdaptiveWindowIsItsDefinition) {
  Random random(7);
  for (const double noise : {0.3e-5, 1e-5, 4e-5}) {
    VelocityFilter filter(AdaptiveWindowFilter{noise}, kStep);
    std::vector<double> x = {0.0}, y = {0.0};
    filter.reset(Vec3::Zero());
    double longest = 0.0;
    for (int k = 1; k < 400; ++k) {
      x.push_back(1e-4 * std::sin(0.02 * k) + 1e-5 * random.uniform());
      y.push_back(std::round(3.7e-6 * k / 1e-5) * 1e-5);
      const Vec3 v = filter.read({x.back(), y.back(), 0.0});
      EXPECT_NEAR(v.x(), longest_line(x, noise), 1e-10) << k;
      EXPECT_NEAR(v.y(), longest_line(y, noise), 1e-10) << k;
      EXPECT_EQ(v.z(), 0.0);
      longest = std::max(longest, std::abs(v.x()));
    }
    EXPECT_GT(longest, 0.0);
  }
}

/// Half a step of error on either end of 15 samples instead of one.
TEST(VelocityFilter, AdaptiveWindowSmoothsARoundedRamp) {
  constexpr double kEncoder = 1e-5, kSpeed = 0.0037;
  VelocityFilter window(AdaptiveWindowFilter{kEncoder}, kStep), difference(DifferenceFilter{}, kStep);
  window.reset(Vec3::Zero());
  difference.reset(Vec3::Zero());
  double worst = 0.0, worst_difference = 0.0;
  for (int k = 1; k < 1000; ++k) {
    const Vec3 x(std::round(kSpeed * k * kStep / kEncoder) * kEncoder, 0, 0);
    const double v = window.read(x).x(), d = difference.read(x).x();
    if (k < 20) continue;
    worst = std::max(worst, std::abs(v - kSpeed));
    worst_difference = std::max(worst_difference, std::abs(d - kSpeed));
  }
  EXPECT_LE(worst, kEncoder / (15 * kStep));
  EXPECT_GT(worst_difference, 0.6 * kEncoder / kStep);
}

TEST(VelocityFilter, AResetForgetsEverything) {
  for (const VelocityFilterConfig& config :
       {VelocityFilterConfig(DifferenceFilter{}), VelocityFilterConfig(LowPassFilter{50.0}),
        VelocityFilterConfig(AdaptiveWindowFilter{1e-3})}) {
    VelocityFilter filter(config, kStep);
    std::vector<Vec3> seen[2];
    for (auto& values : seen) {
      filter.reset({0.1, 0.2, 0.3});
      for (int k = 1; k < 40; ++k) values.push_back(filter.read({0.1 * std::cos(0.1 * k), 0.2, 0.3 + 0.001 * k * k}));
    }
    EXPECT_EQ(seen[0], seen[1]);
  }
}

}  // namespace
}  // namespace hapbench::velocity_filter_test
