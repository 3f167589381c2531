#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "sim/core/random.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::linear_loops_test {
namespace {

/// Returns the loop of an undamped handle of 0.1 kg.
SampledLoop light_loop() {
  SampledLoop loop;
  loop.device.handle_mass = 0.1;
  return loop;
}

/// Returns the loop of an undamped handle of 1 kg with a period of 1 s. The stiffness K then equals alpha = K T^2/m,
/// and the damping B equals beta = B T/m.
SampledLoop unit_loop(double delay, double beta) {
  SampledLoop loop;
  loop.device.handle_mass = loop.period = 1.0;
  loop.device.delay_samples = delay;
  loop.wall_damping = beta;
  return loop;
}

/// Returns the largest limit over beta, found between 0 and 2 by golden-section search; the limit first increases and
/// then decreases.
template <class Limit>
double best_over_damping(Limit limit) {
  const double ratio = std::numbers::phi - 1.0;
  double low = 0.01, high = 1.9;
  while (high - low > 1e-5) {
    const double a = high - ratio * (high - low), b = low + ratio * (high - low);
    (limit(a) < limit(b) ? low : high) = limit(a) < limit(b) ? a : b;
  }
  return limit(0.5 * (low + high));
}

TEST(SampledLoop, RendersAtMostTheseStiffnessesOnAnUndampedHandle) {
  // The published values are rounded to these digits. A delay that differs by half a sample would give other numbers.
  const double published[] = {0.6863, 0.1445, 0.0624, 0.0348};
  for (const int d : {0, 1, 2, 3}) {
    const double largest = best_over_damping([d](double beta) { return linear_stability_limit(unit_loop(d, beta)); });
    EXPECT_NEAR(largest, published[d], 0.00005) << d;
  }
}

TEST(SampledLoop, HasTheLimitOfTheClosedFormWithoutDelay) {
  for (const double beta : {0.01, 0.1, 0.5, 2.0 * std::numbers::sqrt2 - 2.0, 1.2, 1.9}) {
    const double closed = 2.0 * beta * (2.0 - beta) / (2.0 + beta);
    EXPECT_NEAR(linear_stability_limit(unit_loop(0.0, beta)), closed, 1e-10 * closed) << beta;
  }
  EXPECT_EQ(linear_stability_limit(unit_loop(0.0, 2.1)), 0.0);
  EXPECT_EQ(linear_stability_limit(unit_loop(0.0, 0.0)), 0.0) << "nothing damps";
}

TEST(SampledLoop, OfAHandWithASpringMovesAsTheClosedFormHasIt) {
  SampledLoop loop = light_loop();  // no wall: x'' + 2 zeta w x' + w^2 x = 0
  loop.hand = {0.3, 500.0, 2.0};
  const double w = std::sqrt(500.0 / 0.4), zeta = 2.0 / (2.0 * std::sqrt(500.0 * 0.4)), T = loop.period;
  const double wd = w * std::sqrt(1.0 - zeta * zeta), decay = std::exp(-zeta * w * T);
  const Eigen::MatrixXd A = loop.state_matrix();
  EXPECT_NEAR(A(0, 0), decay * (std::cos(wd * T) + zeta * w / wd * std::sin(wd * T)), 1e-15);
  EXPECT_NEAR(A(0, 1) * T, decay * std::sin(wd * T) / wd, 1e-15 * T);
}

/// Returns the smallest K with an eigenvalue on the unit circle, by the frequency response. The wall enters the state
/// matrix as K times a matrix of rank one, u v^T, so an eigenvalue e^(j theta) requires K v^T (e^(j theta) I -
/// A_0)^(-1) u = 1 with a real positive K.
double first_crossing(SampledLoop loop) {
  loop.stiffness = 0.0;
  const Eigen::MatrixXd A = loop.state_matrix();
  loop.stiffness = 1.0;
  const Eigen::MatrixXd wall = loop.state_matrix() - A;
  const Eigen::VectorXcd u = wall.col(0).cast<std::complex<double>>();
  Eigen::Index largest = 0;
  wall.col(0).cwiseAbs().maxCoeff(&largest);
  const Eigen::RowVectorXcd v = (wall.row(largest) / wall(largest, 0)).cast<std::complex<double>>();
  const auto stiffness_at = [&](double theta) {
    const Eigen::MatrixXcd shifted =
        std::polar(1.0, theta) * Eigen::MatrixXcd::Identity(A.rows(), A.rows()) - A.cast<std::complex<double>>();
    return 1.0 / (v * shifted.partialPivLu().solve(u))(0);
  };
  double first = std::numeric_limits<double>::infinity(), low = 1e-3;
  std::complex<double> before = stiffness_at(low);
  for (int i = 1; i <= 2000; ++i) {
    const double high = 1e-3 + (std::numbers::pi - 1e-3) * i / 2000;
    const std::complex<double> at = stiffness_at(high);
    // The imaginary part changes its sign at a crossing or at a pole. The second condition excludes a pole between the
    // two angles.
    if (before.imag() * at.imag() <= 0.0 && std::abs(before - at) < std::abs(at)) {
      double a = low, b = high;
      while (b - a > 1e-13) {
        const double theta = 0.5 * (a + b);
        (stiffness_at(theta).imag() * before.imag() > 0.0 ? a : b) = theta;
      }
      const double K = stiffness_at(a).real();
      if (K > 0.0) first = std::min(first, K);
    }
    before = at;
    low = high;
  }
  return first;
}

TEST(SampledLoop, HasNoCrossingBelowItsLimit) {
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    SampledLoop loop = unit_loop(std::floor(10.0 * random.uniform()) / 4.0, 0.4 * random.uniform());
    loop.device.viscous = 0.05 + 0.1 * random.uniform();
    loop.hand = {2.0 * random.uniform(), i % 2 == 0 ? 0.0 : 0.01 * random.uniform(), 0.0};
    if (i % 3 == 0) loop.device.velocity_filter = LowPassFilter{0.1, static_cast<std::size_t>(1 + i) % 4 + 1};
    if (i % 4 == 1) loop.device.position_filter = LowPassFilter{0.3, 2};
    const double limit = linear_stability_limit(loop);
    ASSERT_GT(limit, 0.0);
    // first_crossing() cannot find a crossing at theta = pi, but no loop in this test has its first crossing there.
    EXPECT_NEAR(first_crossing(loop), limit, 1e-8 * limit) << i;
  }
}

/// Checks a run of the device on bilateral springs, without quantization and dry friction, sample by sample against the
/// linear map of the loop (state_matrix()).
TEST(SampledLoop, IsTheMapOfTheDeviceWithFiltersOfAnyOrder) {
  for (const std::size_t order : {1u, 2u, 3u, 5u, 8u}) {
    for (const bool filters_position : {false, true}) {
      SampledLoop loop = light_loop();
      loop.device.viscous = 0.5;
      loop.device.delay_samples = 0.75;
      loop.device.velocity_filter = LowPassFilter{30.0, order};
      if (filters_position) loop.device.position_filter = LowPassFilter{90.0, order};
      loop.stiffness = 300.0;
      loop.wall_damping = 2.0;
      const Eigen::MatrixXd A = loop.state_matrix();
      ImpedanceDevice device(loop.device, loop.period);
      device.reset({});
      const Vec3 kick(0.7, 0, 0);  // the motors' force of the first period, before there is any contact
      device.drive(kick, Vec3::Zero());
      Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
      // The last component of the state is the delayed force. Because of the delay, the kick acts from 3/4 T on.
      state[A.rows() - 1] = kick.x() * loop.period * loop.period / 0.1;
      const double a = kick.x() / 0.1, h = 0.25 * loop.period, b = 0.5 / 0.1;
      state[0] = a / (b * b) * (b * h - 1.0 + std::exp(-b * h));
      state[1] = loop.period * a / b * (1.0 - std::exp(-b * h));
      double scale = state[0];
      for (int k = 0; k < 300; ++k) {
        const HandleState& tool = device.sampled();
        scale = std::max(scale, std::abs(state[0]));
        // Allow the rounding of the closed form above, a few ulp of a / b^2, and of up to eight modes that are some ten
        // times larger than the input.
        ASSERT_NEAR(device.handle().position.x(), state[0], 1e-9 * scale) << order << " " << k;
        // Before the first sample, the handle rests at zero. Therefore all modes of the filters in the map are zero,
        // too.
        device.drive(-loop.stiffness * tool.position - loop.wall_damping * tool.velocity, Vec3::Zero());
        state = A * state;
      }
      EXPECT_GT(std::abs(state[0]), 0.0);
    }
  }
}

/// Checks a run of the device with a transmission and a hand, sample by sample against the linear map of the loop
/// (state_matrix()), from a state displaced by 1 mm.
TEST(SampledLoop, IsTheMapOfTheDeviceWithATransmission) {
  for (const double delay : {0.0, 1.0, 1.75}) {
    for (const std::size_t order : {1u, 2u}) {
      SampledLoop loop = light_loop();
      loop.device.viscous = 0.5;
      loop.device.delay_samples = delay;
      loop.device.transmission = Transmission{0.3, 2000.0, 0.4};
      loop.device.velocity_filter = LowPassFilter{60.0, order};
      loop.hand = {0.02, 200.0, 0.8};
      loop.stiffness = 150.0;
      loop.wall_damping = 0.5;
      const Eigen::MatrixXd A = loop.state_matrix();
      ImpedanceDevice device(loop.device, loop.period, loop.hand);
      device.reset({.pose = {.position = {1e-3, 0, 0}}});
      Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
      state[0] = state[2] = state[A.rows() - 2] = 1e-3;  // motors, last sample of the motors, handle
      for (int k = 0; k < 400; ++k) {
        const HandleState held = device.handle();
        ASSERT_NEAR(held.position.x(), state[A.rows() - 2], 1e-9 * 1e-3) << delay << " " << order << " " << k;
        ASSERT_NEAR(held.velocity.x() * loop.period, state[A.rows() - 1], 1e-9 * 1e-3);
        const HandleState tool = device.sampled();
        device.drive(-loop.stiffness * tool.position - loop.wall_damping * tool.velocity,
                     -loop.hand.stiffness * held.position - loop.hand.damping * held.velocity);
        state = A * state;
      }
      EXPECT_GT(std::abs(state[0]), 0.0);
    }
  }
}

/// Returns a rotation without special directions.
Mat3 some_rotation() {
  return Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
}

/// Checks a wall along one direction, in a rotated frame. The damping of the hand along this direction differs from its
/// damping perpendicular to the direction.
TEST(ContactLoop, OfAWallInAnyDirectionIsTheLoopOfOneAxis) {
  SampledLoop loop = light_loop();
  loop.device.viscous = 0.5;
  loop.device.delay_samples = 1.25;
  loop.device.velocity_filter = LowPassFilter{60.0, 2};
  loop.wall_damping = 2.0;
  loop.sampled_damping = 20.0;
  const double limit = linear_stability_limit(loop);
  const Vec3 n = some_rotation().col(2);
  const Mat3 along = n * n.transpose(), across = Mat3::Identity() - along;
  const auto stable = [&](double K) {
    LinearContact contact;
    // By the second term, a displacement along another direction causes a force along n, but not conversely.
    contact.rendered.stiffness = K * along + 0.3 * K * n * some_rotation().col(0).transpose();
    contact.rendered.damping = 2.0 * along;
    contact.hand = {300.0 * across, 6.0 * across + 20.0 * along};
    return is_stable_loop(contact_loop(loop, contact));
  };
  EXPECT_TRUE(stable(limit * (1.0 - 1e-6)));
  EXPECT_FALSE(stable(limit * (1.0 + 1e-6)));
}

/// Checks a contact in which the motion along each axis causes forces along the other axes. The simulated motion of the
/// device in three dimensions must decay just below the limit of contact_loop() and grow just above this limit.
TEST(ContactLoop, OfCoupledAxesIsThatOfTheDevice) {
  SampledLoop loop = light_loop();
  loop.device.viscous = 1.0;
  loop.device.delay_samples = 0.5;
  const Mat3 Q = some_rotation();
  const Mat3 shape = Q * Vec3(1.0, 0.4, 0.1).asDiagonal() * Q.transpose();
  LinearContact contact;
  contact.rendered.damping = Vec3(0.5, 2.0, 1.0).asDiagonal();
  contact.hand = {Vec3(100.0, 300.0, 200.0).asDiagonal(), Vec3(3.0, 1.0, 5.0).asDiagonal()};
  const auto loop_at = [&](double K) {
    contact.rendered.stiffness = K * shape;
    return contact_loop(loop, contact);
  };
  ASSERT_EQ(loop_at(500.0).size(), 1u) << "coupled";
  double low = 10.0, high = 1e5;
  while (high / low > 1.0 + 1e-9) {
    const double middle = std::sqrt(low * high);
    (is_stable_loop(loop_at(middle)) ? low : high) = middle;
  }
  const auto grows = [&](double K) {
    ImpedanceDevice device(loop.device, loop.period);
    device.reset({.pose = {.position = {1e-3, -2e-3, 0.5e-3}}});
    double half = 0.0, end = 0.0;
    constexpr int kSteps = 20000;
    for (int k = 0; k < kSteps; ++k) {
      const HandleState tool = device.sampled(), handle = device.handle();
      device.drive(-K * shape * tool.position - contact.rendered.damping * tool.velocity,
                   -contact.hand.stiffness * handle.position - contact.hand.damping * handle.velocity);
      double& largest = k < kSteps / 2 ? half : end;
      if (k >= kSteps / 4) largest = std::max(largest, handle.position.norm());
    }
    return end > half;
  };
  EXPECT_FALSE(grows(0.98 * low));
  EXPECT_TRUE(grows(1.02 * low));
}

std::optional<double> limit(std::string_view name, const SampledLoop& loop) {
  return std::ranges::find(stiffness_limits(), name, &StiffnessLimit::name)->largest(loop);
}

/// Checks that a stiff transmission has no effect, and that a soft transmission resonates and lowers the limit.
TEST(SampledLoop, ATransmissionThatIsStiffIsNone) {
  SampledLoop loop = light_loop();
  loop.device.viscous = 2.0;
  loop.wall_damping = 5.0;
  const double rigid = linear_stability_limit(loop);
  loop.device.transmission = Transmission{0.5, 1e9, 1000.0};
  // The limit is near 2e4 N/m, so the compliance of the transmission changes it by 2e-5.
  EXPECT_NEAR(linear_stability_limit(loop), rigid, 1e-4 * rigid);
  loop.device.transmission = Transmission{0.5, 1e5, 0.1};
  EXPECT_LT(linear_stability_limit(loop), 0.7 * rigid);
  EXPECT_FALSE(limit("stable_gil_hulin", loop)) << "counts on one mass";
  EXPECT_TRUE(limit("passive_with_delay", loop)) << "the transmission is the hand's";
}

TEST(HandFamily, NeedsLessStiffnessThanAnyOfItsHands) {
  SampledLoop loop = light_loop();
  loop.device.viscous = 0.5;
  loop.wall_damping = 5.0;
  const double worst = worst_hand_stability_limit(loop);
  bool met = false;
  for (const AttachedHand& hand : typical_hands()) {
    loop.hand = hand;
    const double limit = linear_stability_limit(loop);
    EXPECT_GE(limit, worst);
    met = met || limit == worst;
  }
  EXPECT_TRUE(met);
}

SampledLoop damped_loop() {
  SampledLoop loop = light_loop();
  loop.device.viscous = 1.5;
  loop.wall_damping = 0.5;
  return loop;
}

TEST(StiffnessLimits, AllowsWithDelayAndWithoutDampingWhatTheClosedFormAllows) {
  SampledLoop loop = damped_loop();
  loop.wall_damping = 0.0;
  for (const double d : {1.0, 2.0, 5.0}) {
    loop.device.delay_samples = d;
    EXPECT_NEAR(*limit("passive_with_delay", loop), 1.5 / (0.001 * (0.5 + d)), 1e-6 / 0.001) << d;
    EXPECT_FALSE(limit("passive_colgate_schenkel", loop)) << "without delay only";
  }
  loop.device.delay_samples = 0.5;
  EXPECT_FALSE(limit("passive_with_delay", loop)) << "the sum over the aliases needs whole delays";
}

/// Checks the inequality of passivity itself, b > T / (2 (1 - cos theta)) Re((1 - e) e^d H) with e = e^(-j theta), on a
/// grid of angles theta. The inequality holds slightly below the limit and fails slightly above it. b is the viscous
/// friction, T the sampling period, d the delay in samples, and H the transfer function of the wall.
TEST(StiffnessLimits, ThePassiveStiffnessIsTheLargestThatMeetsTheInequality) {
  const auto holds = [](const SampledLoop& loop, double K) {
    for (int i = 1; i <= 20000; ++i) {
      const double theta = std::numbers::pi * i / 20000, d = loop.device.delay_samples;
      const auto* filter = std::get_if<LowPassFilter>(&loop.device.velocity_filter);
      const double a = filter != nullptr ? std::exp(-2.0 * std::numbers::pi * filter->cutoff * loop.period) : 0.0;
      const std::complex<double> e = std::polar(1.0, -theta);
      const std::complex<double> H = K + loop.wall_damping * (1.0 - e) / loop.period * (1.0 - a) / (1.0 - a * e);
      const double need = 0.5 * loop.period / (1.0 - std::cos(theta)) * ((1.0 - e) * std::pow(e, d) * H).real();
      if (loop.device.viscous <= need) return false;
    }
    return true;
  };
  for (const double delay : {0.0, 1.0, 3.0}) {
    for (const VelocityFilterConfig& filter : {VelocityFilterConfig(), VelocityFilterConfig(LowPassFilter{60.0})}) {
      SampledLoop loop = damped_loop();
      loop.device.delay_samples = delay;
      loop.device.velocity_filter = filter;
      const double K = *limit("passive_with_delay", loop);
      ASSERT_GT(K, 0.0);
      EXPECT_TRUE(holds(loop, K * (1.0 - 1e-6))) << delay;
      EXPECT_FALSE(holds(loop, K * (1.0 + 1e-6))) << delay;
    }
  }
}

TEST(StiffnessLimits, WhatIsPassiveIsStableWithEveryHand) {
  for (const double delay : {0.0, 1.0, 2.0}) {
    for (const double B : {0.0, 0.3, 1.0}) {
      SampledLoop loop = damped_loop();
      loop.device.delay_samples = delay;
      loop.wall_damping = B;
      // Both limits are exact to 1e-9; at B = 0 without a hand they differ by a thousandth.
      EXPECT_LE(*limit("passive_with_delay", loop), worst_hand_stability_limit(loop) * (1.0 + 1e-9))
          << delay << " " << B;
    }
  }
}

TEST(StiffnessLimits, TheLinearConditionComesCloseToTheExactLimitAtLowDamping) {
  for (const double delay : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    SampledLoop loop = light_loop();  // m/T = 100 N s/m
    loop.device.delay_samples = delay;
    loop.device.viscous = 0.5;
    loop.wall_damping = 1.0;
    EXPECT_NEAR(linear_stability_limit(loop) / *limit("stable_gil_hulin", loop), 1.0, 0.02) << delay;
    const double largest = 0.15 * 100.0 / (1.0 + delay);
    loop.wall_damping = 0.999 * largest - loop.device.viscous;
    const double ratio = linear_stability_limit(loop) / *limit("stable_gil_hulin", loop);
    EXPECT_LT(ratio, 1.0) << delay;
    EXPECT_GT(ratio, 0.86) << delay;
    loop.wall_damping = 1.001 * largest - loop.device.viscous;
    EXPECT_FALSE(limit("stable_gil_hulin", loop)) << "not low any more";
  }
}

TEST(StiffnessLimits, EveryRowSaysWhereItComesFromAndWhenItApplies) {
  for (const StiffnessLimit& limit : stiffness_limits()) {
    for (const char* text : {limit.name, limit.formula, limit.source, limit.applies}) EXPECT_STRNE(text, "");
  }
}

AdmittanceLoop random_loop(Random& random) {
  AdmittanceLoop loop;
  loop.tool.K = 40000.0 * random.uniform();
  loop.tool.B = 100.0 * random.uniform();
  loop.tool.M = 0.05 + 0.2 * random.uniform();
  loop.mechanics.handle_mass = 0.05 + 0.1 * random.uniform();
  loop.mechanics.structure_stiffness = 1e5 * (1.0 + random.uniform());
  loop.servo.delay = static_cast<std::size_t>(4.0 * random.uniform());
  loop.servo.max_force = 1e9;
  loop.hand_stiffness = 1000.0 * random.uniform();
  loop.hand_damping = 10.0 * random.uniform();
  return loop;
}

/// Returns the steps of the simulation with this loop, from a given position and velocity of the tool along x.
std::vector<StepRecord> simulated(const AdmittanceLoop& loop, double position, double velocity, std::uint64_t steps) {
  test::Recorder recorder;
  SimulationConfig config;
  config.dt = loop.tool.dt;
  config.mass = loop.tool.M;
  config.integrator = loop.tool.integrator;
  config.steps = steps;
  config.position = position * Vec3::UnitX();
  config.velocity = velocity * Vec3::UnitX();
  SimulationParts parts = test::fake_parts([&loop](const ToolState& tool) -> Vec3 {
    return -loop.tool.K * tool.pose.position - loop.tool.B * tool.velocity;
  });
  parts.hand = std::make_unique<ImpedanceHand>(loop.hand_stiffness, loop.hand_damping, std::array<Profile, 3>{});
  AdmittanceDeviceConfig device;
  device.force_limit.reset();
  device.servo = loop.servo;
  device.mechanics = loop.mechanics;
  parts.device = std::make_unique<AdmittanceDevice>(device);
  Simulation(config, std::move(parts), {&recorder}).run();
  return recorder.rows;
}

/// Returns the state at the start of a run: handle and carriage at the tool, no delayed command.
Eigen::VectorXd first_state(const AdmittanceLoop& loop, double position, double velocity) {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(loop.state_matrix().rows());
  for (const Eigen::Index i : {0, 2, 4}) {
    state[i] = position;
    state[i + 1] = velocity * loop.tool.dt;
  }
  return state;
}

TEST(AdmittanceLoop, IsTheLinearMapOfTheSimulation) {
  Random random(1);
  for (const IntegratorEntry* integrator : {&kLeapfrog, &kVelocityVerlet, &kRk4}) {
    for (int i = 0; i < 10; ++i) {
      AdmittanceLoop loop = random_loop(random);
      loop.tool.integrator = integrator;
      const double position = 1e-3 * random.normal(), velocity = 0.1 * random.normal();
      const Eigen::MatrixXd A = loop.state_matrix();
      Eigen::VectorXd state = first_state(loop, position, velocity);
      double scale = state.norm();
      for (const StepRecord& row : simulated(loop, position, velocity, 40)) {
        scale = std::max(scale, state.norm());
        const double dt = loop.tool.dt;
        // Allow the rounding of some forty steps of a state that need not decay.
        EXPECT_NEAR(row.tool.pose.position.x(), state[0], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.tool.velocity.x() * dt, state[1], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.handle.position.x(), state[4], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.handle.velocity.x() * dt, state[5], 1e-12 * scale) << row.step;
        state = A * state;
      }
    }
  }
}

/// Checks that runs with hands one per cent softer than the limit decay, and with hands one per cent stiffer grow.
TEST(AdmittanceLoop, HasItsLimitWhereRunsGrow) {
  for (const std::size_t delay : {0u, 1u, 2u}) {
    AdmittanceLoop loop;
    loop.tool.K = 20000.0;
    loop.tool.B = 2.0 * 0.7 * std::sqrt(loop.tool.K * loop.tool.M);
    loop.servo.delay = delay;
    loop.servo.max_force = 1e9;
    loop.hand_damping = 6.0;
    const double limit = first_stability_limit(1.0, 1e9, [loop](double k) mutable {
      loop.hand_stiffness = k;
      return loop.state_matrix();
    });
    ASSERT_GT(limit, 1.0);
    ASSERT_LT(limit, 1e8);
    const auto grows = [&](double factor) {
      loop.hand_stiffness = factor * limit;
      const auto rows = simulated(loop, 1e-6, 0.0, 20000);
      const auto amplitude = [&](std::size_t from) {
        double largest = 0.0;
        for (std::size_t i = from; i < from + 2000; ++i)
          largest = std::max(largest, std::abs(rows[i].handle.velocity.x()));
        return largest;
      };
      return rows.size() < 20000 || amplitude(18000) > amplitude(8000);
    };
    EXPECT_FALSE(grows(0.99)) << delay;
    EXPECT_TRUE(grows(1.01)) << delay;
  }
}

}  // namespace
}  // namespace hapbench::linear_loops_test
