#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::integrators_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Calls check(system) with random spring-dampers on both sides of the stability limits.
template <class Check>
void for_random_systems(const IntegratorEntry* integrator, Check check) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    SpringDamper system{random.uniform(0.0, 4e6), random.uniform(0.0, 1e3), 0.1, 0.0005, random.uniform(0.5, 2.0)};
    if (i % 5 == 0) system.B = 0.0;
    if (i % 5 == 1) system.K = 0.0;
    system.integrator = integrator;
    check(system);
  }
}

/// Returns the matrix of (x, dt v) for one step of M x'' = -lambda (K x + B x'), as the headers of the integrators
/// define it.
Eigen::Matrix2d step_of(const SpringDamper& s) {
  using Matrix = Eigen::Matrix2d;
  const double k = s.lambda * s.K * s.dt * s.dt / s.M, b = s.lambda * s.B * s.dt / s.M, c = 1.0 - 0.5 * b;
  const Matrix I = Matrix::Identity(), G = (Matrix() << 0.0, 1.0, -k, -b).finished(), G2 = G * G;
  if (s.integrator == &kLeapfrog) return (Matrix() << 1.0 - k, 1.0 - b, -k, 1.0 - b).finished();
  if (s.integrator == &kVelocityVerlet) {
    const Matrix kick = (Matrix() << 1.0, 0.0, -0.5 * k, c).finished(),
                 drift = (Matrix() << 1.0, 1.0, 0.0, 1.0).finished();
    return kick * drift * kick;
  }
  if (s.integrator == &kImplicitEuler) return (I - G).inverse();
  if (s.integrator == &kImplicitMidpoint) return (I - 0.5 * G).inverse() * (I + 0.5 * G);
  return I + G + G2 / 2.0 + G2 * G / 6.0 + G2 * G2 / 24.0;  // rk4, and event while the contacts stay the same
}

TEST(IntegratorTable, AStepIsTheMatrixOfItsFormula) {
  for (const IntegratorEntry* entry : kIntegrators) {
    IntegratorEntry stepped = *entry;
    stepped.step_matrix = nullptr;  // the matrix is then computed from steps of the integrator
    for_random_systems(entry, [&](SpringDamper system) {
      const Eigen::Matrix2d expected = step_of(system), scale = Eigen::Vector2d(1.0, system.dt).asDiagonal();
      for (const IntegratorEntry* used : {entry, static_cast<const IntegratorEntry*>(&stepped)}) {
        system.integrator = used;
        // Allow a few roundings of terms up to the fourth power of 30.
        EXPECT_LE((scale * system.step_matrix() * scale.inverse() - expected).norm(), 1e-12 * expected.norm())
            << entry->info.name << ' ' << system.K << ' ' << system.B;
      }
    });
  }
}

TEST(IntegratorTable, MarginsArePositiveExactlyWhereAStepIsStable) {
  for (const IntegratorEntry* entry : kIntegrators) {
    if (entry->stability_margin == nullptr) continue;
    for_random_systems(entry, [&](const SpringDamper& system) {
      const double margin = entry->stability_margin(system);
      if (std::abs(margin) < 1e-9) return;  // on the limit itself, up to rounding
      EXPECT_EQ(margin > 0.0, system.is_stable()) << entry->info.name << " " << system.K << " " << system.B;
    });
  }
}

/// Checks that a step slightly below a limit is stable and a step slightly above it is not. Without a limit every step
/// is stable.
TEST(IntegratorTable, DampersAloneAreStableUpToTheirLimits) {
  constexpr double kMargin = 1e-6;
  for (const IntegratorEntry* entry : kIntegrators) {
    SCOPED_TRACE(entry->info.name);
    const double limit = std::min(entry->damper_limit, 1e9);
    const auto at = [&](double beta) { return SpringDamper{0.0, beta * 0.1 / 0.0005, 0.1, 0.0005, 1.0, entry}; };
    EXPECT_TRUE(at(limit * (1.0 - kMargin)).is_stable());
    EXPECT_EQ(at(limit * (1.0 + kMargin)).is_stable(), std::isinf(entry->damper_limit));
    if (std::isinf(entry->damper_limit))
      for_random_systems(entry, [](const SpringDamper& system) { EXPECT_TRUE(system.is_stable()); });
  }
}

/// Force of a linear spring-damper that is equal in all directions. Counts its evaluations.
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

TEST(Integrators, AskForTheForceAsOftenAsTheySay) {
  const std::map<const IntegratorEntry*, int> beside_the_row = {{&kVelocityVerlet, 1}, {&kRk4, 3}, {&kEvent, 4}};
  for (const IntegratorEntry* integrator : kIntegrators) {
    SpringField field(20000.0, 5.0);
    ToolState tool{{Vec3(0.001, 0.0, -0.002), -Vec3::UnitZ()}, Vec3(0.3, -0.1, 0.0)};
    integrator->step(tool, Vec3::UnitX(), kMass, 0.0005, field, kEventTolerance);
    EXPECT_EQ(field.calls, beside_the_row.contains(integrator) ? beside_the_row.at(integrator) : 0)
        << integrator->info.name;
    EXPECT_EQ(tool.pose.axis, Vec3(-Vec3::UnitZ()));
  }
}

/// Force of a spring along x that pushes towards -x at positions x > 0. At x <= 0 the force is zero.
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

/// Returns the relative change of the speed of a mass that bounces on the spring, and the duration of the contact in
/// units of half a period.
std::pair<double, double> bounce(const IntegratorEntry& integrator, double dt, double tolerance) {
  constexpr double kSpeed = 0.2, kGap = 4.13e-4;
  OneSidedSpring field;
  ToolState tool;
  tool.pose.position = Vec3(-kGap, 0.0, 0.0);
  tool.velocity = Vec3(kSpeed, 0.0, 0.0);
  double time = 0.0;
  for (; tool.velocity.x() > 0.0 || tool.pose.position.x() > -kGap; time += dt)
    integrator.step(tool, field.force_at(0.0, tool.pose.position, tool.velocity), kMass, dt, field, tolerance);
  // Time [s] since the mass passed the start position on its way back.
  const double late = (-kGap - tool.pose.position.x()) / -tool.velocity.x();
  const double contact = time - late - kGap / kSpeed - kGap / -tool.velocity.x();
  return {-tool.velocity.x() / kSpeed - 1.0,
          contact / (std::numbers::pi * std::sqrt(kMass / OneSidedSpring::kStiffness))};
}

/// Checks a bounce: contact lasts half a period, and the tool leaves with the speed of its arrival. Let w be the
/// angular frequency of mass and spring, and h the step. With h = 0.1 ms, w h is 0.045. Between the events, kEvent
/// makes Runge-Kutta steps. In each of 70 steps, they lose the fraction (w h)^6 / 144 of the speed, 4e-9 in total.
/// They make the contact longer by the fraction (w h)^4 / 120 = 3e-8.
TEST(Event, FindsContactOnAndOffWithinAStep) {
  const auto [gain, duration] = bounce(kEvent, 1e-4, 1e-12);
  EXPECT_NEAR(gain, 0.0, 1e-8);
  EXPECT_NEAR(duration, 1.0, 1e-7);
  EXPECT_GT(std::abs(bounce(kRk4, 1e-4, 1e-12).first), 1e-7) << "blind for the events";
  // If the tolerance is a whole step, the integrator equals Runge-Kutta.
  EXPECT_EQ(bounce(kEvent, 1e-4, 1e-4), bounce(kRk4, 1e-4, 1e-4));
}

/// Force field with a constant Jacobian. The implicit integrators evaluate no force within the step.
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
    // If S has eigenvalues above 1, friction f gives the damping D = B S + f (I - S), whose eigenvalues may have both
    // signs and any size.
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
    kImplicitEuler.step(tool, force, kMass, 0.0005, field, kEventTolerance);
    // The velocity change is at most twice the change by the explicit step with the same impulse.
    const Vec3 impulse = 0.0005 * (force - 0.0005 * (jacobian.stiffness * v));
    ASSERT_TRUE(tool.velocity.allFinite());
    ASSERT_LE((tool.velocity - v).norm(), 2.0 * impulse.norm() / kMass * (1.0 + 1e-12));
  }
}

TEST(LinearlyImplicit, AnswersAnInfiniteJacobianWithTheExplicitStep) {
  for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    ToolState tool;
    HeldJacobian field({Mat3::Zero(), Mat3::Constant(bad)});
    kImplicitMidpoint.step(tool, {1, 0, 0}, 0.5, 0.25, field, kEventTolerance);
    EXPECT_EQ(tool.velocity, Vec3(0.5, 0, 0));
  }
}

// ---- Integrators in the step loop

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
    for (const StepRecord& row : recorder.rows) {
      EXPECT_EQ(row.tool.pose.position, tool.pose.position);
      EXPECT_EQ(row.tool.velocity, tool.velocity);
      EXPECT_EQ(row.force.rendered, law(tool)) << "rows are evaluated at their own states";
      integrator->step(tool, row.force.rendered, config.mass, config.dt, field, kEventTolerance);
    }
  }
}

/// Algorithm that records the states at which it is evaluated and renders no force.
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

/// Returns the states that an algorithm receives from a tool that tilts from -z towards -x, about y, at 3 rad/s.
std::vector<ToolState> seen_of_a_turn(const IntegratorEntry* integrator, std::uint64_t steps, double cutoff) {
  std::vector<ToolState> seen;
  SimulationParts parts = test::fake_parts(test::weightless);
  parts.algorithm = std::make_unique<Witness>(seen, cutoff);
  parts.motion = std::make_unique<ScriptedMotion>(kTurn, std::nullopt);
  Simulation(config_of(integrator, steps), std::move(parts), {}).run();
  return seen;
}

TEST(IntegratorInTheLoop, SeesTheAxisAndTheTurnOfItsTime) {
  // Times within a step at which each integrator evaluates the force, the start of the step first.
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
      // The angular velocity of a rotation by 1e-3 rad has a relative error of eps / 1e-3.
      const double rate = i == 0 ? 0.0 : 3.0;
      EXPECT_NEAR(seen[i].angular_velocity.norm(), rate, 1e-11) << i;
    }
  }
}

/// Checks the step response of a first-order low-pass, at every time at which an integrator evaluates the force.
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

}  // namespace
}  // namespace hapbench::integrators_test
