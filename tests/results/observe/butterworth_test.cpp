#include "results/observe/contact_forces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace hapbench::butterworth_test {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<double> impulse_response(HighPass filter, std::size_t n) {
  std::vector<double> h(n);
  filter.settle_at(Vec3::Zero());
  for (std::size_t k = 0; k < n; ++k) h[k] = filter.filter({k == 0 ? 1.0 : 0.0, 0.0, 0.0}).x();
  return h;
}

std::complex<double> response(const std::vector<double>& h, double frequency, double sampling_rate) {
  std::complex<double> sum = 0.0;
  for (std::size_t k = 0; k < h.size(); ++k) {
    sum += h[k] * std::polar(1.0, -2.0 * kPi * frequency / sampling_rate * static_cast<double>(k));
  }
  return sum;
}

/// H(s) = s^4 / prod (s - p_i) with poles p_i on the left half of the unit circle, s = j tan(pi f / fs) / tan(pi fc /
/// fs).
std::complex<double> butterworth(double frequency, double cutoff, double sampling_rate) {
  const std::complex<double> s(0.0, std::tan(kPi * frequency / sampling_rate) / std::tan(kPi * cutoff / sampling_rate));
  std::complex<double> H = 1.0;
  for (const int i : {5, 7, 9, 11}) H *= s / (s - std::polar(1.0, kPi * i / 8.0));
  return H;
}

class HighPassAt : public testing::TestWithParam<double> {};

TEST_P(HighPassAt, HasTheResponseOfTheAnalogueFilterAtTheWarpedFrequency) {
  const double sampling_rate = GetParam();
  const HighPass filter(30.0, sampling_rate);
  // The slowest pole pair decays as exp(-cos(3 pi/8) 2 pi 30 t) = exp(-72 t): after 2 s nothing is left in double.
  const std::vector<double> h = impulse_response(filter, static_cast<std::size_t>(2.0 * sampling_rate));
  for (const double f : {0.0, 1.0, 10.0, 25.0, 30.0, 35.0, 0.25 * sampling_rate, 0.45 * sampling_rate}) {
    const std::complex<double> expected = butterworth(f, 30.0, sampling_rate);
    // Rounding: the poles are at a distance d >= 72 / fs from the unit circle, so an error of one ulp in a step lives
    // for 1/d steps, twice (two sections); 1e-16 (4096/72)^2 = 4e-13 is the worst case here.
    EXPECT_NEAR(std::abs(response(h, f, sampling_rate) - expected), 0.0, 1e-12) << f << " Hz";
  }
}

// Engine step of the thesis, its platform, twice that, and a rate at which the warping is strong.
INSTANTIATE_TEST_SUITE_P(SamplingRate, HighPassAt, testing::Values(2000.0, 2048.0, 4096.0, 100.0));

TEST(HighPass, PassesHalfOfThePowerAtItsCutoff) {
  const std::vector<double> h = impulse_response(HighPass(30.0, 2000.0), 4000);
  EXPECT_NEAR(std::norm(response(h, 30.0, 2000.0)), 0.5, 1e-12);
}

TEST(HighPass, SettledAtAConstantGivesExactlyZero) {
  HighPass filter(30.0, 2000.0);
  const Vec3 value(0.1, -1e3, 1.0 / 3.0);
  filter.settle_at(value);
  for (int k = 0; k < 100; ++k) ASSERT_EQ(filter.filter(value), Vec3::Zero());
}

TEST(HighPass, SettlingForgetsThePast) {
  HighPass used(30.0, 2000.0);
  used.settle_at(Vec3::Zero());
  for (int k = 0; k < 10; ++k) used.filter({1.0, 2.0, 3.0});
  used.settle_at(Vec3::UnitX());
  HighPass fresh(30.0, 2000.0);
  fresh.settle_at(Vec3::UnitX());
  for (int k = 0; k < 10; ++k) ASSERT_EQ(used.filter(Vec3::UnitY()), fresh.filter(Vec3::UnitY()));
}

TEST(HighPass, TreatsComponentsAlike) {
  HighPass filter(30.0, 2000.0);
  filter.settle_at(Vec3::Zero());
  for (int k = 0; k < 10; ++k) {
    const Vec3 out = filter.filter({1.0 * k, 1.0 * k, -1.0 * k});
    ASSERT_EQ(out.x(), out.y());
    ASSERT_EQ(out.x(), -out.z());
  }
}

}  // namespace
}  // namespace hapbench::butterworth_test
