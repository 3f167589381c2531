#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::integrators_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// A mass on a linear spring-damper, the same in every direction.
class SpringField final : public ForceField {
 public:
  SpringField(double stiffness, double damping) : K(stiffness), B(damping) {}
  Vec3 force_at(double, const Vec3& position, const Vec3& velocity) noexcept override {
    ++calls;
    return -K * position - B * velocity;
  }
  ForceJacobian jacobian() const noexcept override { return {K * Mat3::Identity(), B * Mat3::Identity()}; }

  double K, B;
  int calls = 0;
};

constexpr double kMass = 0.2;

ToolState displaced() {
  return {{Vec3(0.001, 0.0, -0.002), -Vec3::UnitZ()}, Vec3(0.3, -0.1, 0.0)};
}

ToolState run(const IntegratorEntry* integrator, SpringField field, double dt, int steps) {
  ToolState tool = displaced();
  const auto stepper = integrator->make({});
  for (int i = 0; i < steps; ++i) {
    const Vec3 force = -field.K * tool.pose.position - field.B * tool.velocity;
    stepper->step(tool, force, kMass, dt, field);
  }
  return tool;
}

double energy(const ToolState& tool, double K) {
  return 0.5 * (kMass * tool.velocity.squaredNorm() + K * tool.pose.position.squaredNorm());
}

/// The exact state after the time t, from the matrix exponential of (w x, v), w^2 = K / M, which is well scaled.
ToolState exact(const SpringField& field, double t) {
  Eigen::Matrix2d A;
  const double w = std::sqrt(field.K / kMass);
  A << 0.0, w, -w, -field.B / kMass;
  const Eigen::Matrix2d advance = (A * t).exp();
  ToolState tool = displaced();
  const Vec3 p = tool.pose.position, v = tool.velocity;
  tool.pose.position = advance(0, 0) * p + advance(0, 1) / w * v;
  tool.velocity = advance(1, 0) * w * p + advance(1, 1) * v;
  return tool;
}

/// Distance of two states as the root of an energy, which does not pass through zero as an error in position does.
double error(const ToolState& a, const ToolState& b, double K) {
  ToolState difference = a;
  difference.pose.position -= b.pose.position;
  difference.velocity -= b.velocity;
  return std::sqrt(energy(difference, K));
}

TEST(Integrators, ConvergeWithTheirOrders) {
  constexpr double kEnd = 0.0173;
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double B : {0.0, 20.0}) {
      const SpringField field(20000.0, B);
      const auto error_of = [&](int steps) {
        return error(run(integrator, field, kEnd / steps, steps), exact(field, kEnd), field.K);
      };
      const double order = std::log2(error_of(400) / error_of(800));
      // error = C h^p (1 + D h + ...): w h = 0.014 at the coarser step, and D is of the order of w times the 5 radians
      // of the run, so that the ratio is 2^p to within some 3.5 %, log2 of which is 0.05.
      EXPECT_NEAR(order, B == 0.0 ? integrator->order : integrator->damped_order, 0.05)
          << integrator->info.name << " B = " << B;
    }
  }
}

TEST(Integrators, AskForTheForceAsOftenAsTheySay) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    SpringField field(20000.0, 5.0);
    ToolState tool = displaced();
    integrator->make({})->step(tool, Vec3::UnitX(), kMass, 0.0005, field);
    EXPECT_EQ(field.calls, integrator->forces - 1) << integrator->info.name << " beside the row's";
    EXPECT_EQ(tool.pose.axis, Vec3(-Vec3::UnitZ()));
  }
}

TEST(Integrators, MoveAFreeMassAlike) {
  // A constant force: only methods of order 1 differ from the parabola, by half a step's fall.
  struct Constant final : ForceField {
    Vec3 force_at(double, const Vec3&, const Vec3&) noexcept override { return {0, 0, -2}; }
    ForceJacobian jacobian() const noexcept override { return {}; }
  } field;
  for (const IntegratorEntry* integrator : kIntegrators) {
    ToolState tool;
    integrator->make({})->step(tool, {0, 0, -2}, 0.5, 0.25, field);
    EXPECT_EQ(tool.velocity, Vec3(0, 0, -1)) << integrator->info.name;
    const bool first_order = integrator->order == 1;
    EXPECT_NEAR(tool.pose.position.z(), first_order ? -0.25 : -0.125, 4 * kEps) << integrator->info.name;
  }
}

/// A spring along x that only pushes, from x = 0 on.
class OneSidedSpring final : public ForceField {
 public:
  Vec3 force_at(double, const Vec3& position, const Vec3&) noexcept override {
    touches_ = position.x() > 0.0;
    return Vec3(touches_ ? -kStiffness * position.x() : 0.0, 0.0, 0.0);
  }
  std::uint64_t contact_set() const noexcept override { return touches_ ? 1 : 0; }
  ForceJacobian jacobian() const noexcept override { return {}; }

  static constexpr double kStiffness = 20000.0;

 private:
  bool touches_ = false;
};

/// How much faster than it came a mass leaves the spring, as a share, and when it is where it started, in half periods
/// of contact after it touched.
std::pair<double, double> bounce(const IntegratorEntry& integrator, double dt, double tolerance) {
  constexpr double kSpeed = 0.2, kGap = 4.13e-4;
  const auto stepper = integrator.make({.tolerance = tolerance});
  OneSidedSpring field;
  ToolState tool;
  tool.pose.position = Vec3(-kGap, 0.0, 0.0);
  tool.velocity = Vec3(kSpeed, 0.0, 0.0);
  double time = 0.0;
  for (; tool.velocity.x() > 0.0 || tool.pose.position.x() > -kGap; time += dt)
    stepper->step(tool, field.force_at(0.0, tool.pose.position, tool.velocity), kMass, dt, field);
  const double late = (-kGap - tool.pose.position.x()) / -tool.velocity.x();  // since it passed the start
  const double contact = time - late - kGap / kSpeed - kGap / -tool.velocity.x();
  return {-tool.velocity.x() / kSpeed - 1.0,
          contact / (std::numbers::pi * std::sqrt(kMass / OneSidedSpring::kStiffness))};
}

/// Contact lasts half a period, and the tool leaves as fast as it came. In steps of 0.1 ms w h is 0.045: Runge-Kutta
/// loses (w h)^6 / 144 of the energy in each of 70 steps, 4e-9, and is late by (w h)^4 / 120 = 3e-8.
TEST(Event, FindsContactOnAndOffWithinAStep) {
  const auto [gain, duration] = bounce(kEvent, 1e-4, 1e-12);
  EXPECT_NEAR(gain, 0.0, 1e-8);
  EXPECT_NEAR(duration, 1.0, 1e-7);
  EXPECT_GT(std::abs(bounce(kRk4, 1e-4, 1e-12).first), 1e-7) << "blind for the events";
  // Where it may be late by a step, it is Runge-Kutta.
  EXPECT_EQ(bounce(kEvent, 1e-4, 1e-4), bounce(kRk4, 1e-4, 1e-4));
}

TEST(ImplicitMidpoint, IsTheTrapezoidalRuleOnASpringDamper) {
  // (I - h/2 A) y' = (I + h/2 A) y, solved by hand.
  for (const double K : {0.0, 20000.0, 1e9}) {
    for (const double B : {0.0, 50.0, 2e4}) {
      const SpringField field(K, B);
      const double dt = 0.0005, k = K * dt * dt / kMass, b = B * dt / kMass;
      const ToolState start = displaced(), moved = run(&kImplicitMidpoint, field, dt, 1);
      const double D = 1.0 + 0.5 * b + 0.25 * k;
      const Vec3 p = ((1.0 + 0.5 * b - 0.25 * k) * start.pose.position + dt * start.velocity) / D;
      const Vec3 v = ((1.0 - 0.5 * b - 0.25 * k) * start.velocity - k / dt * start.pose.position) / D;
      // A dozen roundings of the terms, of which the largest is k p / dt over D, at most 4 p / dt.
      const double size = start.velocity.norm() + 4.0 * start.pose.position.norm() / dt;
      EXPECT_LE((moved.velocity - v).norm(), 12 * kEps * size) << K << " " << B;
      EXPECT_LE((moved.pose.position - p).norm(), 12 * kEps * dt * size) << K << " " << B;
    }
  }
}

TEST(ImplicitMidpoint, KeepsTheEnergyOfUndampedSpringsHoweverStiff) {
  for (const double K : {20000.0, 1e6, 1e9}) {
    const double start = energy(displaced(), K);
    constexpr int kSteps = 10'000;
    // Each step rounds position and velocity, some ten times.
    EXPECT_NEAR(energy(run(&kImplicitMidpoint, {K, 0.0}, 0.0005, kSteps), K), start, 10 * kSteps * kEps * start) << K;
  }
}

TEST(ImplicitEuler, TakesItsShareOfTheEnergyInEveryStep) {
  for (const double K : {20000.0, 1e6, 1e9}) {
    const double k = K * 0.0005 * 0.0005 / kMass;
    double before = energy(displaced(), K);
    for (int steps = 1; steps <= 5; ++steps) {
      const double now = energy(run(&kImplicitEuler, {K, 0.0}, 0.0005, steps), K);
      // The map is normal in the norm of the energy, with eigenvalues of modulus 1 / sqrt(1 + k). Stiff springs lose
      // digits of what is left to what was there: the force is known to eps, and k of it cancels.
      EXPECT_NEAR(now / before, 1.0 / (1.0 + k), 100 * kEps * (1.0 + k)) << K << " step " << steps;
      before = now;
    }
  }
}

TEST(VelocityVerlet, SwingsAboutItsEnergyWithoutDrift) {
  // M v^2 / 2 + (1 - k/4) K x^2 / 2 is kept, so the energy stays between it and it / (1 - k/4).
  const double K = 20000.0, k = K * 0.0005 * 0.0005 / kMass;
  const SpringField field(K, 0.0);
  const auto kept = [&](const ToolState& tool) {
    return energy(tool, K) - 0.125 * k * K * tool.pose.position.squaredNorm();
  };
  const ToolState tool = run(&kVelocityVerlet, field, 0.0005, 100'000);
  EXPECT_NEAR(kept(tool), kept(displaced()), 1e6 * kEps * kept(displaced()));
}

TEST(RungeKutta, DissipatesAsItsAmplificationSays) {
  const double K = 20000.0, k = K * 0.0005 * 0.0005 / kMass;
  const double factor = 1.0 - k * k * k / 72.0 + k * k * k * k / 576.0;  // |1 + z + ... + z^4 / 24|^2, z = i sqrt(k)
  const double end = energy(run(&kRk4, {K, 0.0}, 0.0005, 1000), K);
  EXPECT_NEAR(end / energy(displaced(), K), std::pow(factor, 1000), 1000 * 20 * kEps);
}

/// Holds a Jacobian that no step asks to be evaluated elsewhere.
class HeldJacobian final : public ForceField {
 public:
  explicit HeldJacobian(ForceJacobian jacobian) : jacobian_(std::move(jacobian)) {}
  Vec3 force_at(double, const Vec3&, const Vec3&) noexcept override { return Vec3::Zero(); }
  ForceJacobian jacobian() const noexcept override { return jacobian_; }

 private:
  ForceJacobian jacobian_;
};

TEST(LinearlyImplicit, CopesWithDampingThatDrives) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    // Friction on a law whose S exceeds 1: D = B S + f (I - S) of both signs, as large as one likes.
    Mat3 S = Mat3::Zero();
    for (int j = 0; j < 3; ++j) {
      const Vec3 u = random.direction();
      S += 20.0 * random.uniform(0.0, 1.0) * u * u.transpose();
    }
    const double K = std::pow(10.0, random.uniform(0.0, 12.0)), f = std::pow(10.0, random.uniform(0.0, 9.0));
    const ForceJacobian jacobian{K * S, 50.0 * S + f * (Mat3::Identity() - S)};
    ToolState tool;
    tool.velocity = random.direction();
    const Vec3 force = 1e3 * random.direction(), v = tool.velocity;
    HeldJacobian field(jacobian);
    kImplicitEuler.make({})->step(tool, force, kMass, 0.0005, field);
    // Never more than twice what the explicit step would make of the same impulse.
    const Vec3 impulse = 0.0005 * (force - 0.0005 * (jacobian.stiffness * v));
    ASSERT_TRUE(tool.velocity.allFinite());
    ASSERT_LE((tool.velocity - v).norm(), 2.0 * impulse.norm() / kMass * (1.0 + 1e-12));
  }
}

TEST(LinearlyImplicit, AnswersAnInfiniteJacobianWithTheExplicitStep) {
  for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    ToolState tool;
    HeldJacobian field({Mat3::Zero(), Mat3::Constant(bad)});
    kImplicitMidpoint.make({})->step(tool, {1, 0, 0}, 0.5, 0.25, field);
    EXPECT_EQ(tool.velocity, Vec3(0.5, 0, 0));
  }
}

// ---- In the step loop.

SimulationConfig config_of(const IntegratorEntry* integrator, std::uint64_t steps) {
  SimulationConfig config;
  config.integrator = integrator;
  config.steps = steps;
  config.position = {0.001, 0.002, 0.003};
  config.velocity = {0.1, 0.0, -0.1};
  return config;
}

TEST(IntegratorInTheLoop, MovesTheToolAsItDoesAlone) {
  for (const IntegratorEntry* integrator : {&kLeapfrog, &kVelocityVerlet, &kRk4}) {
    test::Recorder recorder;
    const SimulationConfig config = config_of(integrator, 50);
    SpringField field(20000.0, 50.0);
    const auto law = [](const ToolState& t) { return Vec3(-20000.0 * t.pose.position - 50.0 * t.velocity); };
    Simulation(config, test::fake_parts(law), {&recorder}).run();
    ToolState tool = recorder.rows[0].tool;
    const auto stepper = integrator->make({});
    for (const StepRecord& row : recorder.rows) {
      EXPECT_EQ(row.tool.pose.position, tool.pose.position);
      EXPECT_EQ(row.tool.velocity, tool.velocity);
      EXPECT_EQ(row.force.rendered, law(tool)) << "rows are evaluated at their own states";
      stepper->step(tool, row.force.rendered, config.mass, config.dt, field);
    }
  }
}

/// Notes what it is asked for.
class Witness final : public ForceAlgorithm {
 public:
  Witness(std::vector<ToolState>& seen, double cutoff) : seen_(&seen), cutoff_(cutoff) {}
  void prepare(const Scene&) override {}
  void reset() noexcept override {}
  void compute(const ToolState& tool, ContactBuffer&, RenderedForce& out) noexcept override {
    seen_->push_back(tool);
    out = {};
  }
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return {}; }
  ForceJacobian jacobian() const noexcept override { return {}; }
  std::optional<double> angular_velocity_cutoff() const noexcept override { return cutoff_; }

 private:
  std::vector<ToolState>* seen_;
  double cutoff_;
};

const Orientation kTurn{{0, 0, 1}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 3.0}), {}};

/// The states that an algorithm sees of a tool that tilts from -z towards -x, about y, at 3 rad/s.
std::vector<ToolState> seen_of_a_turn(const IntegratorEntry* integrator, std::uint64_t steps, double cutoff) {
  std::vector<ToolState> seen;
  SimulationParts parts = test::fake_parts(test::weightless);
  parts.algorithm = std::make_unique<Witness>(seen, cutoff);
  parts.motion = std::make_unique<ScriptedMotion>(kTurn, std::nullopt);
  Simulation(config_of(integrator, steps), std::move(parts), {}).run();
  return seen;
}

TEST(IntegratorInTheLoop, SeesTheAxisAndTheTurnOfItsTime) {
  // Where in a step each asks for the force, first in the row.
  const std::pair<const IntegratorEntry*, std::vector<double>> integrators[] = {
      {&kVelocityVerlet, {0.0, 1.0}}, {&kRk4, {0.0, 0.5, 0.5, 1.0}}, {&kEvent, {0.0, 0.5, 0.5, 1.0, 1.0}}};
  for (const auto& [integrator, parts] : integrators) {
    SCOPED_TRACE(integrator->info.name);
    const auto seen = seen_of_a_turn(integrator, 3, std::numeric_limits<double>::infinity());
    const std::size_t forces = parts.size();
    ASSERT_EQ(seen.size(), 3 * forces);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double t = (static_cast<double>(i / forces) + parts[i % forces]) * SimulationConfig{}.dt;
      EXPECT_LE((seen[i].pose.axis - tool_axis(kTurn, 0.1 + 3.0 * t, 0.0)).norm(), 4 * kEps);
      // Turns of 1e-3 rad are known to eps / 1e-3.
      const double rate = i == 0 ? 0.0 : 3.0;
      EXPECT_NEAR(seen[i].angular_velocity.norm(), rate, 1e-11) << i;
    }
  }
}

/// The step response of a first-order low-pass, at every time an integrator asks.
TEST(IntegratorInTheLoop, SeesTheTurnThroughTheLowPassOfTheAlgorithm) {
  constexpr double kCutoff = 40.0;
  const double dt = SimulationConfig{}.dt;
  const auto response = [&](double t) { return 3.0 * (1.0 - std::exp(-2.0 * std::numbers::pi * kCutoff * t)); };
  const auto rows = seen_of_a_turn(&kLeapfrog, 40, kCutoff);
  ASSERT_EQ(rows.size(), 40u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_LE((rows[k].angular_velocity - Vec3(0.0, response(static_cast<double>(k) * dt), 0.0)).norm(), 1e-11) << k;
  }
  const auto within = seen_of_a_turn(&kRk4, 3, kCutoff);
  ASSERT_EQ(within.size(), 12u);
  for (std::size_t i = 0; i < within.size(); ++i) {
    constexpr double kParts[] = {0.0, 0.5, 0.5, 1.0};
    const double t = (static_cast<double>(i / 4) + kParts[i % 4]) * dt;
    EXPECT_NEAR(within[i].angular_velocity.norm(), response(t), 1e-11) << i;
  }
}

/// Moves the tool by 1 in its first step and by one more in each that follows.
class Counting final : public Integrator {
 public:
  void reset() noexcept override { steps_ = 0; }
  void step(ToolState& tool, const Vec3&, double, double, ForceField&) noexcept override {
    tool.pose.position.x() += ++steps_;
  }

 private:
  int steps_ = 0;
};

TEST(IntegratorInTheLoop, MayKeepAStateThatResetForgets) {
  const IntegratorEntry counting = {.info = {}, .make = [](const IntegratorOptions&) -> std::unique_ptr<Integrator> {
                                      return std::make_unique<Counting>();
                                    }};
  test::Recorder recorder;
  SimulationConfig config = config_of(&counting, 4);
  config.position = Vec3::Zero();
  Simulation simulation(config, test::fake_parts(test::weightless), {&recorder});
  simulation.run();
  simulation.reset();
  simulation.run();
  ASSERT_EQ(recorder.rows.size(), 8u);
  for (const std::size_t run : {0u, 4u}) {
    for (const auto& [row, x] : {std::pair{0u, 0.0}, {1u, 1.0}, {2u, 3.0}, {3u, 6.0}}) {
      EXPECT_EQ(recorder.rows[run + row].tool.pose.position.x(), x) << run << " " << row;
    }
  }
}

TEST(IntegratorInTheLoop, HoldsTheInputForceOverTheStep) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    SimulationParts parts = test::fake_parts(test::weightless);
    parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{Profile::Shape(Profile::Ramp{1.0, 1000.0}), 0, 0});
    SimulationConfig config = config_of(integrator, 2);
    config.velocity = Vec3::Zero();
    test::Recorder recorder;
    Simulation(config, std::move(parts), {&recorder}).run();
    EXPECT_NEAR(recorder.rows[1].tool.velocity.x(), 1.0 / config.mass * config.dt, 4 * kEps) << integrator->info.name;
  }
}

TEST(IntegratorInTheLoop, LeavesAPrescribedPositionAlone) {
  std::vector<StepRecord> leapfrog_rows;
  for (const IntegratorEntry* integrator : kIntegrators) {
    test::Calls calls;
    SimulationParts parts = test::fake_parts([](const ToolState&) { return Vec3(1e6, 0, 0); }, &calls);
    parts.motion = std::make_unique<ScriptedMotion>(
        Orientation{}, std::array<Profile, 3>{Profile::Shape(Profile::Sine{0.0, 0.002, 0.1, 0.3}), 0.1, 0.2});
    test::Recorder recorder;
    Simulation(config_of(integrator, 100), std::move(parts), {&recorder}).run();
    EXPECT_EQ(calls.compute, 100) << "nobody asks within a step";
    if (leapfrog_rows.empty()) leapfrog_rows = recorder.rows;
    for (std::size_t k = 0; k < 100; ++k) {
      EXPECT_EQ(recorder.rows[k].tool.pose.position, leapfrog_rows[k].tool.pose.position);
      EXPECT_EQ(recorder.rows[k].tool.velocity, leapfrog_rows[k].tool.velocity);
    }
  }
}

using test::leapfrog;

/// A mass on a spring-damper along x.
struct Oscillator {
  double B = 0.0, K = 20000.0, M = 0.2, dt = 0.0005;
  ToolState tool = {{{0.001, 0, 0}}, {0.3, 0, 0}};

  void step() { leapfrog(tool, {-K * x() - B * v(), 0, 0}, M, dt); }
  double x() const { return tool.pose.position.x(); }
  double v() const { return tool.velocity.x(); }
  double energy() const { return 0.5 * M * v() * v() + 0.5 * K * x() * x(); }
};

TEST(Leapfrog, VelocityIsUpdatedBeforePosition) {
  // Dyadic numbers: exact.
  ToolState tool;
  tool.pose.position = {1, 2, 3};
  tool.velocity = {0.5, 0.0, -1.0};
  leapfrog(tool, {2, 4, -8}, 4.0, 0.25);
  EXPECT_EQ(tool.velocity, Vec3(0.625, 0.25, -1.5));
  EXPECT_EQ(tool.pose.position, Vec3(1.15625, 2.0625, 2.625));
}

TEST(Leapfrog, FollowsTheClosedFormOfItsRecurrence) {
  // With b = B dt/M and k = K dt^2/M the positions obey x_{j+1} = (2 - b - k) x_j - (1 - b) x_{j-1}: powers of the
  // roots of z^2 - (2 - b - k) z + (1 - b), from x_0 and x_1.
  for (const double B : {0.0, 5.0, 88.5}) {
    Oscillator o{B};
    const double b = o.B * o.dt / o.M, k = o.K * o.dt * o.dt / o.M;
    using Complex = std::complex<double>;
    const Complex root = std::sqrt(Complex((2 - b - k) * (2 - b - k) - 4 * (1 - b)));
    const Complex z1 = 0.5 * (2 - b - k + root), z2 = 0.5 * (2 - b - k - root);
    const double x0 = o.x();
    o.step();
    const double x1 = o.x();
    const Complex c1 = (x1 - z2 * x0) / (z1 - z2), c2 = (z1 * x0 - x1) / (z1 - z2);
    const double amplitude = std::abs(c1) + std::abs(c2);
    constexpr int steps = 1000;
    // Each step rounds its three terms, and a disturbance of the recurrence echoes with the amplitude 2 / |z1 - z2|.
    const double tolerance = steps * 8 * kEps * amplitude * 2.0 / std::abs(z1 - z2);
    ASSERT_LT(tolerance, 1e-9 * amplitude);
    for (int j = 2; j <= steps; ++j) {
      o.step();
      const double exact = (c1 * std::pow(z1, j) + c2 * std::pow(z2, j)).real();
      ASSERT_NEAR(o.x(), exact, tolerance) << "B = " << B << ", step " << j;
    }
  }
}

TEST(Leapfrog, ConservesItsModifiedEnergy) {
  Oscillator o;
  const auto modified = [&o] { return o.energy() - 0.5 * o.K * o.dt * o.x() * o.v(); };
  const double start = modified();
  constexpr int steps = 100000;
  for (int j = 0; j < steps; ++j) {
    o.step();
    ASSERT_NEAR(modified(), start, steps * 8 * kEps * start);
  }
}

TEST(Leapfrog, ConstantForceGivesTheDiscreteParabola) {
  // v_j = j a dt and x_j = a dt^2 j (j + 1) / 2: exact in dyadic numbers.
  ToolState tool;
  for (int j = 1; j <= 1000; ++j) {
    leapfrog(tool, {0, 0, -2}, 0.5, 0x1p-10);
    EXPECT_EQ(tool.velocity.z(), -4 * 0x1p-10 * j);
    EXPECT_EQ(tool.pose.position.z(), -4 * 0x1p-20 * j * (j + 1) / 2);
  }
}

}  // namespace
}  // namespace hapbench::integrators_test
