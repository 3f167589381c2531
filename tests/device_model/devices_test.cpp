#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/impedance_device.hpp"
#include "sim/core/random.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::devices_test {
namespace {

// Compares the parts of an impedance device, and the device in the loop of the simulation, with recurrences.

constexpr double kT = 0.001, kMass = 0.1;

TEST(ForcePath, ChangesNothingByDefault) {
  ForcePath path({}, kT);
  const Vec3 force(1.0 / 3.0, -200.0, 1e-9);
  EXPECT_EQ(path.hold(force).after, force);
  EXPECT_EQ(path.switch_fraction(), 0.0);
}

TEST(ForcePath, RoundsToTheStepHalvesAwayFromZero) {
  ForcePath path({.force_step = 0.25}, kT);
  EXPECT_EQ(path.hold({0.125, -0.125, 0.124}).after, Vec3(0.25, -0.25, 0.0));
  EXPECT_EQ(path.hold({1.0, 0.9, -7.3}).after, Vec3(1.0, 1.0, -7.25));
}

TEST(ForcePath, SaturatesTheNormAfterRounding) {
  ForcePath path({.force_max = 5.0, .force_step = 1.0}, kT);
  EXPECT_EQ(path.hold({3.2, 4.1, 0.0}).after, Vec3(3, 4, 0)) << "at the limit";
  EXPECT_EQ(path.hold({6.0, 8.0, 0.4}).after, Vec3(3, 4, 0));
}

TEST(ForcePath, LimitsTheChangeOfTheForce) {
  ForcePath path({.force_slew = 1000.0}, kT);  // 1 N per period
  EXPECT_EQ(path.hold({3.0, 0.0, 0.0}).after, Vec3(1, 0, 0)) << "from zero";
  EXPECT_EQ(path.hold({3.0, 0.0, 0.0}).after, Vec3(2, 0, 0));
  EXPECT_EQ(path.hold({2.5, 0.0, 0.0}).after, Vec3(2.5, 0, 0));
  EXPECT_EQ(path.hold({-9.0, 0.0, 0.0}).after, Vec3(1.5, 0, 0));
  path.reset();
  EXPECT_EQ(path.hold({0.0, -3.0, 0.0}).after, Vec3(0, -1, 0));
}

TEST(ForcePath, DelaysByWholeAndFractionalPeriods) {
  for (const double delay : {0.0, 0.25, 1.0, 2.5, 3.0}) {
    ForcePath path({.delay_samples = delay}, kT);
    EXPECT_EQ(path.switch_fraction(), delay - std::floor(delay));
    for (int round = 0; round < 2; ++round) {
      for (int k = 0; k < 10; ++k) {
        // The force k + 1 N of sample k acts from sample k + delay on. Before the first force, the motors' force is
        // zero.
        const HeldForce held = path.hold({k + 1.0, 0, 0});
        EXPECT_EQ(held.after.x(), std::max(0.0, k + 1.0 - std::floor(delay))) << delay;
        EXPECT_EQ(held.before.x(), std::max(0.0, k - std::floor(delay))) << delay;
      }
      path.reset();
    }
  }
}

TEST(VelocityFilter, DifferenceIsThatOfTheLastTwoSamples) {
  VelocityFilter filter(DifferenceFilter{}, kT);
  filter.reset({1, 1, 1});
  EXPECT_EQ(filter.read({1.5, 1, 0}), Vec3((1.5 - 1) / kT, 0, (0 - 1) / kT));
  EXPECT_EQ(filter.read({1.5, 1, 0}), Vec3(0, 0, 0));
}

/// With w = 2 pi f, the step responses of the continuous Butterworth low-passes are 1 - e^(-w t), 1 - sqrt(2) e^(-w t /
/// sqrt 2) sin(w t / sqrt 2 + pi / 4) and 1 - e^(-w t) - (2 / sqrt 3) e^(-w t / 2) sin(sqrt 3 w t / 2). The sampled
/// filters have the same response to a step of the velocity from 0 to 1.
TEST(VelocityFilter, LowPassesAnswerAStepLikeTheContinuousOnes) {
  constexpr double w = 2.0 * std::numbers::pi * 20.0;
  VelocityFilter first(LowPassFilter{20.0}, kT), second(LowPassFilter{20.0, 2}, kT), third(LowPassFilter{20.0, 3}, kT);
  for (VelocityFilter* filter : {&first, &second, &third}) filter->reset(Vec3::Zero());
  for (int k = 1; k <= 200; ++k) {
    const double t = k * kT, r = w * t / std::numbers::sqrt2, s = 0.5 * std::numbers::sqrt3 * w * t;
    EXPECT_NEAR(first.read({t, 0, -t}).x(), -std::expm1(-w * t), 1e-12);
    EXPECT_NEAR(second.read({t, 0, 0}).x(),
                1.0 - std::numbers::sqrt2 * std::exp(-r) * std::sin(r + 0.25 * std::numbers::pi), 1e-12);
    EXPECT_NEAR(third.read({t, 0, 0}).x(),
                1.0 - std::exp(-w * t) - 2.0 / std::numbers::sqrt3 * std::exp(-0.5 * w * t) * std::sin(s), 1e-12);
  }
}

/// For a slow sine of frequency f, a filter of order n with the cut-off f_c passes the fraction |H|^2 = 1 / (1 + (f /
/// f_c)^(2 n)) of the power. The sampled filter passes less, because it holds each sample over a period T. The loss is
/// a fraction below (pi f T)^2.
TEST(SampledLowPass, HasHalfThePowerAtItsCutOffWhateverItsOrder) {
  for (std::size_t order = 1; order <= LowPassFilter::kMaxOrder; ++order) {
    for (const double f : {2.0, 4.0, 6.0}) {
      std::complex<double> response = 0.0;
      for (const LowPassMode& mode : low_pass_modes({4.0, order}, kT))
        response += mode.response(2.0 * std::numbers::pi * f * kT);
      const double power = 1.0 / (1.0 + std::pow(f / 4.0, 2.0 * static_cast<double>(order)));
      EXPECT_NEAR(std::norm(response) / power, 1.0, 0.05) << order << " " << f;
    }
    SampledLowPass filter({4.0, order}, kT);
    filter.settle_at({1, 2, 3});
    // The tolerance exceeds the rounding of the input, because the modes of filters of high order are tens of times
    // larger than the input.
    EXPECT_NEAR((filter.filter({1, 2, 3}) - Vec3(1, 2, 3)).norm(), 0.0, 1e-12) << order;
  }
}

TEST(ImpedanceDevice, ItsNoiseIsThatOfTheSeedAndGaussian) {
  ImpedanceDeviceConfig config;
  config.position_noise = 2e-6;
  const auto readings = [](const ImpedanceDeviceConfig& of) {
    ImpedanceDevice device(of, kT);
    std::vector<double> x;
    device.reset({});
    for (int k = 0; k < 20'000; ++k) {
      x.push_back(device.sampled().position.y());
      device.drive(Vec3::Zero(), Vec3::Zero());
    }
    device.reset({});
    EXPECT_EQ(device.sampled().position.y(), x[0]) << "a reset repeats it";
    return x;
  };
  const auto x = readings(config);
  EXPECT_EQ(readings(config), x);
  config.seed = 5;
  EXPECT_NE(readings(config), x);
  double squares = 0.0, beyond = 0.0;
  for (const double value : x) squares += value * value, beyond += std::abs(value) > 2e-6 ? 1.0 : 0.0;
  // Allow four standard errors of 20 000 values: 2 % of the standard deviation, and 1.3 % for the fraction beyond one
  // standard deviation, which is 31.7 %.
  EXPECT_NEAR(std::sqrt(squares / 20'000) / 2e-6, 1.0, 0.02);
  EXPECT_NEAR(beyond / 20'000, 0.3173, 0.0132);
}

/// Returns the slope of the longest window that ends at the last sample and whose samples lie on a line. The window
/// grows from 1 interval as long as all its samples differ from the line through its ends by at most the noise. Unlike
/// the filter, this function gets all samples at once.
double longest_line(const std::vector<double>& x, double noise) {
  const std::size_t k = x.size() - 1;
  double slope = 0.0;
  for (std::size_t n = 1; n <= std::min<std::size_t>(k, 15); ++n) {
    for (std::size_t j = k - n; j <= k; ++j) {
      const double line = x[k - n] + (x[k] - x[k - n]) * static_cast<double>(j - (k - n)) / static_cast<double>(n);
      if (std::abs(line - x[j]) > noise + 1e-15) return slope;
    }
    slope = (x[k] - x[k - n]) / (static_cast<double>(n) * kT);
  }
  return slope;
}

TEST(VelocityFilter, AdaptiveWindowIsItsDefinition) {
  Random random(7);
  for (const double noise : {0.3e-5, 1e-5, 4e-5}) {
    VelocityFilter filter(AdaptiveWindowFilter{noise}, kT);
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

TEST(DevicePresets, HaveNamesOfTheirOwnAndPossibleNumbers) {
  for (const DevicePreset& preset : device_presets()) {
    EXPECT_EQ(find_device_preset(preset.name), &preset);
    const ImpedanceDeviceConfig config = config_of(preset);
    EXPECT_GT(config.handle_mass, 0.0);
    EXPECT_GE(config.viscous, 0.0);
    EXPECT_GE(config.coulomb, 0.0);
    EXPECT_GT(config.encoder_step, 0.0);
    EXPECT_GT(config.force_max.value(), 0.0);
    EXPECT_GT(preset.max_stiffness.value, 0.0);
    EXPECT_EQ(preset.max_stiffness.source, kFromChai3d);
    EXPECT_GT(preset.max_damping.value, 0.0);
    const ImpedanceDeviceConfig soft = config_of(preset, PresetVariant::soft),
                                stiff = config_of(preset, PresetVariant::stiff);
    EXPECT_EQ(soft.coulomb, 0.0) << "no friction of these devices is published";
    EXPECT_EQ(stiff.coulomb, 2.0 * config.coulomb);
    EXPECT_LE(soft.handle_mass, config.handle_mass);
    EXPECT_EQ(soft.handle_mass < stiff.handle_mass, preset.handle_mass.source == kOurEstimate);
    EXPECT_EQ(soft.encoder_step > stiff.encoder_step, preset.encoder_step.source == kOurEstimate);
  }
  EXPECT_EQ(find_device_preset("touch")->max_stiffness.value, 400.0);
  EXPECT_EQ(find_device_preset("Touch"), nullptr);
}

/// Returns the records of all steps of a run. The device renders the force `law`(tool), and a hand pushes with the
/// force `push` [N] along x.
std::vector<StepRecord> rows_of(const ImpedanceDeviceConfig& config, test::FakeAlgorithm::Law law, std::uint64_t steps,
                                const Vec3& start, const Vec3& velocity = Vec3::Zero(), double push = 0.0) {
  SimulationParts parts = test::fake_parts(std::move(law));
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{push, 0.0, 0.0});
  parts.device = std::make_unique<ImpedanceDevice>(config, kT);
  SimulationConfig run;
  run.dt = kT;
  run.steps = steps;
  run.mass = 1e9;  // must not affect the result
  run.position = start;
  run.velocity = velocity;
  test::Recorder recorder;
  Simulation(run, std::move(parts), {&recorder}).run();
  return recorder.rows;
}

/// Returns the law of a wall that pushes along +x at x < 0.
test::FakeAlgorithm::Law wall(double K, double B) {
  return [=](const ToolState& t) {
    const double x = t.pose.position.x();
    return x < 0.0 ? Vec3(-K * x - B * t.velocity.x(), 0, 0) : Vec3(0, 0, 0);
  };
}

TEST(ImpedanceDevice, AFractionalDelayChangesTheForceWithinThePeriod) {
  constexpr double K = 1500.0, B = 5.0, kDelay = 1.25, x0 = -0.001;
  ImpedanceDeviceConfig config;
  config.handle_mass = kMass;
  config.delay_samples = kDelay;
  const auto rows = rows_of(config, wall(K, B), 200, {x0, 0, 0});
  double x = x0, v = 0.0, last = x0;
  std::vector<double> f;
  for (std::size_t k = 0; k < 200; ++k) {
    EXPECT_NEAR(rows[k].tool.pose.position.x(), x, 1e-12) << k;
    EXPECT_NEAR(rows[k].handle.velocity.x(), v, 1e-10) << k;
    f.push_back(x < 0.0 ? -K * x - B * (x - last) / kT : 0.0);
    last = x;
    for (const auto& [part, age] : {std::pair<double, std::size_t>{0.25, 2}, {0.75, 1}}) {
      const double a = k >= age ? f[k - age] / kMass : 0.0, h = part * kT;
      x += v * h + 0.5 * a * h * h;
      v += a * h;
    }
  }
}

TEST(ImpedanceDevice, TheToolIsAtTheMeasuredPosition) {
  constexpr double q = 1.0 / 4096;
  ImpedanceDeviceConfig config;
  config.handle_mass = kMass;
  config.encoder_step = q;
  const auto rows = rows_of(config, test::weightless, 100, {2.5 * q, -2.5 * q, 0.4 * q}, {0.031, 0.0, -0.017});
  EXPECT_EQ(rows[0].tool.pose.position, Vec3(3 * q, -3 * q, 0)) << "halves away from zero";
  EXPECT_EQ(rows[0].tool.velocity, Vec3(0, 0, 0));
  EXPECT_EQ(rows[0].handle.position, Vec3(2.5 * q, -2.5 * q, 0.4 * q)) << "the true one";
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Vec3 measured = rows[k].tool.pose.position;
    EXPECT_LE((measured - rows[k].handle.position).cwiseAbs().maxCoeff(), 0.5 * q);
    EXPECT_EQ(measured.x() / q, std::round(measured.x() / q));
    EXPECT_EQ(rows[k].tool.velocity, Vec3((measured - rows[k - 1].tool.pose.position) / kT));
  }
}

/// Checks that a push beyond the saturation of the motors moves the handle, and that a smaller push does not.
TEST(ImpedanceDevice, SaturatedMotorsYield) {
  for (const double push : {-2.9, -3.1}) {
    ImpedanceDeviceConfig config;
    config.handle_mass = kMass;
    config.viscous = 5.0;
    config.force_max = 3.0;
    const auto rows = rows_of(config, wall(1000.0, 5.0), 4000, Vec3::Zero(), Vec3::Zero(), push);
    // The push of 3.1 N exceeds the saturation of 3 N by 0.1 N. This difference moves the handle at 0.1 N / (5 N s/m) =
    // 0.02 m/s for four seconds.
    EXPECT_EQ(rows.back().handle.position.x() < -0.05, push < -3.0);
  }
}

TEST(ImpedanceDevice, AResetRepeatsEverythingBitForBit) {
  ImpedanceDeviceConfig config = config_of(*find_device_preset("touch"));
  for (const VelocityFilterConfig& filter :
       {VelocityFilterConfig(DifferenceFilter{}), VelocityFilterConfig(LowPassFilter{50.0, 4}),
        VelocityFilterConfig(AdaptiveWindowFilter{3e-5})}) {
    if (std::holds_alternative<AdaptiveWindowFilter>(filter)) config.transmission = Transmission{0.4, 5000.0, 0.5};
    config.delay_samples = 2.3;
    config.velocity_filter = filter;
    config.force_step = 0.01;
    config.force_slew = 500.0;
    SimulationParts parts = test::fake_parts(wall(500.0, 1.0));
    parts.hand =
        std::make_unique<ForceHand>(std::array<Profile, 3>{Profile::Shape(Profile::Sine{-1, 2, 0.1, 0}), 0.1, 0});
    parts.device = std::make_unique<ImpedanceDevice>(config, kT);
    SimulationConfig run;
    run.dt = kT;
    run.steps = 500;
    run.position = {0.002, 0, 0};
    test::Recorder recorder;
    Simulation simulation(run, std::move(parts), {&recorder});
    simulation.run();
    simulation.reset();
    simulation.run();
    ASSERT_EQ(recorder.rows.size(), 1000u);
    for (std::size_t k = 0; k < 500; ++k) {
      EXPECT_EQ(recorder.rows[k].handle.position, recorder.rows[k + 500].handle.position);
      EXPECT_EQ(recorder.rows[k].tool.velocity, recorder.rows[k + 500].tool.velocity);
    }
  }
}

// Tests the admittance device and its parts. The tests AdmittanceLoop in linear_loops_test.cpp compare the device with
// a linear map.

constexpr double kStep = 1.0 / 2048;

TEST(InputForceLimiter, ScalesLongerForcesToTheLimitAndLeavesOthersUntouched) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 u = random.direction(), shorter = random.uniform() * random.direction();
    const double limit = random.uniform(0.1, 10.0);
    const Vec3 limited = limit_input_force(limit * random.uniform(1.0, 100.0) * u, limit);
    EXPECT_LE((limited - limit * u).norm(), 4 * std::numeric_limits<double>::epsilon() * limit);
    EXPECT_EQ(limit_input_force(shorter, 1.0), shorter);
  }
  EXPECT_EQ(limit_input_force({3, 4, 0}, 5.0), Vec3(3, 4, 0)) << "the limit itself";
  EXPECT_EQ(limit_input_force({3, 4, 0}, 0.0), Vec3(0, 0, 0));
  EXPECT_EQ(limit_input_force({0, 0, 0}, 0.0), Vec3(0, 0, 0));
}

TEST(ForceSensor, NoiseHasTheGivenDeviationInEveryComponentAndNoMean) {
  const double sigma = 0.02;
  ForceSensor sensor({.weight = 0.0, .noise = sigma, .seed = 5});
  constexpr int kSamples = 100'000;
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero(), products = Vec3::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 e = sensor.read({0, 0, 0}) / sigma;
    sum += e;
    squares += e.cwiseAbs2();
    products += Vec3(e.x() * e.y(), e.y() * e.z(), e.z() * e.x());
  }
  // Allow five standard errors: 1 / sqrt(n) for the mean and for a product, sqrt(2 / n) for the square.
  const double error = 5.0 / std::sqrt(kSamples);
  EXPECT_LE((sum / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((products / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((squares / kSamples - Vec3::Ones()).cwiseAbs().maxCoeff(), std::sqrt(2.0) * error);
}

TEST(ForceSensor, TheSeedDecidesTheNoiseAndAResetRepeatsIt) {
  const auto first_reading = [](std::uint64_t seed) {
    return ForceSensor({.noise = 1.0, .seed = seed}).read({0, 0, 0});
  };
  EXPECT_NE(first_reading(1), first_reading(2));
  ForceSensor sensor({.noise = 1.0, .seed = 1});
  const Vec3 first = sensor.read({0, 0, 0});
  EXPECT_NE(sensor.read({0, 0, 0}), first);
  sensor.reset();
  EXPECT_EQ(sensor.read({0, 0, 0}), first);
}

ToolState reference(const Vec3& position, const Vec3& velocity) {
  ToolState tool;
  tool.pose.position = position;
  tool.velocity = velocity;
  return tool;
}

TEST(PositionServo, SaturatesAtTheNormOfItsForce) {
  PositionServo servo({.stiffness = 1, .damping = 0, .max_force = 30, .delay = 0});
  EXPECT_EQ(servo.force(reference({18, 24, 0}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0}), Vec3(18, 24, 0)) << "30 N";
  const Vec3 saturated = servo.force(reference({300, 0, -400}, {0, 0, 0}), {0, 0, 0}, {0, 0, 0});
  EXPECT_LE((saturated - Vec3(18, 0, -24)).norm(), 1e-14);
}

TEST(HandleMechanics, TheStructureSwingsAtItsFrequency) {
  HandleMechanicsConfig config;
  config.friction = config.structure_damping = 0.0;
  HandleMechanics mechanics(config);
  mechanics.reset({});
  // An impulse makes handle and carriage oscillate against each other.
  constexpr double kFine = 1e-6;
  mechanics.advance({1000, 0, 0}, {0, 0, 0}, kFine);
  const auto stretch = [&] { return mechanics.handle().position.x() - mechanics.carriage().position.x(); };
  double last = stretch();
  std::vector<double> crossings;
  for (int i = 1; crossings.size() < 3; ++i) {
    mechanics.advance({0, 0, 0}, {0, 0, 0}, kFine);
    if (last < 0.0 && stretch() >= 0.0) crossings.push_back((i - stretch() / (stretch() - last)) * kFine);
    last = stretch();
  }
  const double reduced = 1.0 / (1.0 / config.carriage_mass + 1.0 / config.handle_mass);
  const double period = 2.0 * std::numbers::pi * std::sqrt(reduced / config.structure_stiffness);
  // The midpoint rule lengthens a period by (omega dt)^2 / 12 = 3e-7 of the period; the error of the interpolation is
  // smaller.
  EXPECT_NEAR(crossings[2] - crossings[1], period, 1e-6 * period);
}

TEST(HandleMechanics, KeepsItsEnergyBalanceToRounding) {
  Random random(3);
  for (int run = 0; run < 50; ++run) {
    HandleMechanics mechanics({.carriage_mass = random.uniform(0.01, 2),
                               .handle_mass = random.uniform(0.01, 2),
                               .friction = random.uniform(0, 50),
                               .structure_stiffness = random.uniform(0, 1e7),
                               .structure_damping = random.uniform(0, 500)});
    ToolState tool;
    tool.velocity = random.direction();
    mechanics.reset(tool);
    double turnover = 0.0;
    for (int i = 0; i < 2000; ++i) {
      mechanics.advance(5.0 * random.direction(), 30.0 * random.direction(), kStep);
      const DeviceEnergy e = mechanics.energy();
      turnover = std::max({turnover, std::abs(e.hand), std::abs(e.actuator), -e.dissipated, std::abs(e.stored)});
      // Each step rounds sums of the size of the exchanged energy, which includes elastic energy: 1e-16 per step.
      ASSERT_NEAR(e.stored, e.hand + e.actuator + e.dissipated, 1e-12 * (turnover + 1.0));
      ASSERT_LE(e.dissipated, 0.0);
    }
  }
}

TEST(AdmittanceDevice, TheLimitTakesHoldWhereTheThesisSeesIt) {
  AdmittanceDevice device({});
  for (const double push : {0.5, 1.5, 1.999, 2.0, 2.5, 10.0}) {
    const MeasuredForce force = device.measure({0, 0, -push});
    EXPECT_NEAR(force.measured.z(), -push - 0.7, 1e-15) << "the log holds the weight: 2.7 N at the limit (Fig. 6)";
    EXPECT_NEAR(force.input.z(), -std::min(push, 2.0), 1e-15);
  }
}

TEST(AdmittanceDevice, WithoutCompensationTheWeightPullsAndTheLimitCountsIt) {
  AdmittanceDeviceConfig config;
  config.sensor.compensated = false;
  AdmittanceDevice device(config);
  EXPECT_NEAR(device.measure({0, 0, 0}).input.z(), -0.7, 1e-15);
  EXPECT_NEAR(device.measure({0, 0, -1.5}).input.z(), -2.0, 1e-15);
}

TEST(AdmittanceDevice, AHandThatPushesFindsServoAndStructureInSeries) {
  const AdmittanceDeviceConfig config;
  AdmittanceDevice device(config);
  device.reset({});
  for (int i = 0; i < 8192; ++i) device.advance({}, {0, 0, -4}, kStep);
  const double compliance = 1.0 / config.servo.stiffness + 1.0 / config.mechanics.structure_stiffness;
  EXPECT_NEAR(device.handle().position.z(), -4.0 * compliance, 1e-9 * compliance);
}

TEST(AdmittanceDevice, AHandStrongerThanTheActuatorsMovesTheHandle) {
  for (const double push : {29.0, 31.0}) {
    AdmittanceDevice device({});
    device.reset({});
    for (int i = 0; i < 8192; ++i) device.advance({}, {0, 0, -push}, kStep);
    // A force of 1 N beyond the limit of 30 N acts for four seconds against a friction of 2 N s/m: the handle moves by
    // metres.
    EXPECT_EQ(device.handle().position.z() < -0.5, push > 30.0);
  }
}

TEST(AdmittanceDevice, AResetRepeatsEverythingBitForBit) {
  AdmittanceDeviceConfig config;
  config.sensor.noise = 0.1;
  AdmittanceDevice device(config);
  std::vector<Vec3> seen[2];
  for (auto& values : seen) {
    device.reset({});
    ToolState tool;
    tool.pose.position.x() = 0.01;
    for (int i = 0; i < 100; ++i) {
      values.push_back(device.measure({1, 2, 3}).input);
      device.advance(tool, {1, 2, 3}, kStep);
      values.push_back(device.handle().position);
    }
  }
  EXPECT_EQ(seen[0], seen[1]);
}

}  // namespace
}  // namespace hapbench::devices_test
