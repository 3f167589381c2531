#include "results/observe/perception.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace hapbench::perception_test {
namespace {

constexpr double kRate = 4000.0;

/// Rows in contact, with a force and a handle's velocity over time.
template <class Force, class Velocity>
PerceptionMetrics observed(PerceptionObserver observer, Force force, Velocity velocity, int rows) {
  for (int row = 0; row < rows; ++row) {
    StepRecord record;
    record.time = row / kRate;
    record.colliding = 1;
    record.force.rendered = Vec3(force(record.time), 0.0, 0.0);
    record.handle.velocity = Vec3(velocity(record.time), 0.0, 0.0);
    observer.on_step(record);
  }
  return observer.metrics();
}

double zero(double) {
  return 0.0;
}

TEST(Perception, TheThresholdIsTheAccelerationOfAVibrationThatIsJustFelt) {
  PerceptionThresholds t;
  t.amplitude_at_250Hz = 2e-7;
  EXPECT_NEAR(t.acceleration_rms(), 2e-7 * std::pow(2 * std::numbers::pi * 250, 2) / std::sqrt(2.0), 1e-15);
}

TEST(Perception, AVibrationInTheBandHasTheRmsOfItsAcceleration) {
  const PerceptionThresholds t;
  // A difference over one step stands for the derivative: sin(x)/x with x = pi f / fs; the filters let 125 Hz pass to
  // (40 / 125)^8 = 1e-4 and (125 / 400)^8 of the power.
  const double f = 125.0, omega = 2 * std::numbers::pi * f, amplitude = 0.01;
  const auto velocity = [=](double time) { return amplitude * std::sin(omega * time); };
  const PerceptionMetrics m = observed(PerceptionObserver(t, nullptr, 1 / kRate), zero, velocity, 40'000);
  const double x = std::numbers::pi * f / kRate;
  const double expected = amplitude * omega * std::sin(x) / x / std::sqrt(2.0);
  EXPECT_NEAR(*m.acceleration_rms, expected, 1e-3 * expected);
  EXPECT_EQ(m.threshold_rms, t.acceleration_rms());
}

TEST(Perception, SlowMotionAndWhatIsBeyondTheBandAreNotFelt) {
  for (const double f : {4.0, 1900.0}) {
    const double omega = 2 * std::numbers::pi * f;
    const auto velocity = [=](double time) { return std::cos(omega * time); };
    const PerceptionMetrics m = observed(PerceptionObserver({}, nullptr, 1 / kRate), zero, velocity, 40'000);
    // A tenth of the low end: 1e-8 of the power; 1900 Hz, warped, is some 37 times the high end. What is left is the
    // start, from rest to 1 m/s at once, 4000 m/s^2 in one row of 40 000: some per cent of 4000 / 200.
    EXPECT_LT(*m.acceleration_rms, 20.0) << f;
  }
}

TEST(Perception, AForceErrorIsNoticedBeyondItsShareOfTheReference) {
  const ReferenceForce reference(std::array<Profile, 3>{2.0, 0.0, 0.0});
  const auto force = [](double time) { return time < 0.05 ? 2.19 : 2.21; };  // 10 % of 2 N is 0.2 N
  const PerceptionMetrics m = observed(PerceptionObserver({}, &reference, 1 / kRate), force, zero, 400);
  EXPECT_EQ(m.reference_rows, 400u);
  EXPECT_EQ(m.error_rows, 200u);
}

TEST(Perception, AVibrationOfTheForceIsNoticedBeyondItsShareOfTheRest) {
  for (const double amplitude : {0.05, 0.5}) {
    const auto force = [=](double time) { return 2.0 + amplitude * std::sin(2 * std::numbers::pi * 200 * time); };
    const PerceptionMetrics m = observed(PerceptionObserver({}, nullptr, 1 / kRate), force, zero, 8000);
    const double share = static_cast<double>(m.vibration_rows) / static_cast<double>(m.rows_in_contact);
    // A steady vibration is noticed in every row or in none, but for the start: the step of 2 N dies out within a few
    // periods of 30 Hz, some hundred of 8000 rows, and five periods of 30 Hz, 666 rows, later its square is below
    // (2 N)^2 e^-5 / 2 < (0.2 N)^2 / 2.
    EXPECT_NEAR(share, amplitude > 0.2 ? 1.0 : 0.0, 0.1);
  }
}

TEST(Perception, AtALowRateThereIsNoBand) {
  EXPECT_FALSE(PerceptionObserver({}, nullptr, 0.02).metrics().acceleration_rms);
  EXPECT_FALSE(PerceptionObserver({}, nullptr, 0.02).metrics().vibration_is_sampled);
  // 600 Hz of sampling end within the band of 40 to 400 Hz.
  EXPECT_FALSE(observed(PerceptionObserver({}, nullptr, 1.0 / 600.0), zero, zero, 100).acceleration_rms);
  EXPECT_TRUE(observed(PerceptionObserver({}, nullptr, 1.0 / 900.0), zero, zero, 100).acceleration_rms);
}

}  // namespace
}  // namespace hapbench::perception_test
