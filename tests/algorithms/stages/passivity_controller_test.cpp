#include "algorithms/stages/controllers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/fakes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::passivity_controller_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Keeps the smallest observed energy [J] and the largest rendered force [N] of a run. `turnover` is the largest sum of
/// observed and kinetic energy in a step [J], which is the scale of rounding errors.
class Watch final : public Observer {
 public:
  Watch(double dt, double mass) : observed_(dt), dt_(dt), mass_(mass) {}
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& r) noexcept override {
    observed_.move(r.tool);
    observed_.answer(r.tool, r.force.rendered, r.springs);
    const Vec3 w = r.tool.velocity + r.hand.input * (0.5 * dt_ / mass_);
    smallest = std::min(smallest, observed_.energy());
    turnover = std::max(turnover, std::abs(observed_.energy()) + 0.5 * mass_ * w.squaredNorm());
    force_max = std::max(force_max, r.force.rendered.norm());
  }
  double smallest = std::numeric_limits<double>::infinity();
  double turnover = 0.0;
  double force_max = 0.0;
  /// Returns a bound of the rounding error of one step [J].
  double rounding() const { return 50 * kEpsilon * turnover; }

 private:
  ObservedEnergy observed_;
  double dt_, mass_;
};

struct Ran {
  Watch watch;
  ToolState tool;
  std::uint64_t controlled = 0;
};

Ran run(const SimulationConfig& config, SimulationParts parts) {
  Ran ran{Watch(config.dt, config.mass), {}, 0};
  Simulation simulation(config, std::move(parts), {&ran.watch});
  simulation.run();
  ran.tool = simulation.tool();
  ran.controlled = simulation.algorithm().work().steps_controlled;
  return ran;
}

SimulationParts controlled(SimulationParts parts, const RenderingConfig& config = {}) {
  parts.algorithm = std::make_unique<PassivityController>(std::move(parts.algorithm), config);
  return parts;
}

/// Checks that the controller keeps any law under any hand passive. The law renders random forces that are independent
/// of the tool; their largest magnitude is 1e-3 … 1e5 N. The force of the hand is a sine of random amplitude and period
/// along each axis. The observed energy must stay above zero and the rendered force within its limit.
TEST(PassivityController, KeepsAnyForceUnderAnyHandPassive) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    const auto numbers = std::make_shared<Random>(seed);
    const double size = std::pow(10.0, 8.0 * numbers->uniform() - 3.0);
    RenderingConfig config;
    config.mass = std::pow(10.0, 2.0 * numbers->uniform() - 1.5);
    if (seed % 2 == 0) config.max_force = size * numbers->uniform();
    SimulationConfig run_config = test::thrown(200);
    run_config.mass = config.mass;
    const double limit = config.max_force.value_or(std::numeric_limits<double>::infinity());
    SimulationParts parts = test::fake_parts([numbers, size, limit](const ToolState&) -> Vec3 {
      return std::min(limit, size * numbers->uniform()) * numbers->direction();
    });
    const auto wave = [&] {
      return Profile(
          Profile::Shape(Profile::Sine{0.0, 5.0 * numbers->uniform(), 0.003 + 0.1 * numbers->uniform(), 0.0}));
    };
    parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{wave(), wave(), wave()});
    const Ran ran = run(run_config, controlled(std::move(parts), config));
    EXPECT_GE(ran.watch.smallest, -ran.watch.rounding());
    if (config.max_force) {
      EXPECT_LE(ran.watch.force_max, *config.max_force * (1.0 + 4.0 * kEpsilon));
    }
  }
}

/// Renders no force and no moment in the first two steps. In all later steps, renders random forces of at most `limit`
/// [N] and random moments, which do not depend on the tool.
class Lever final : public ForceAlgorithm {
 public:
  Lever(std::uint64_t seed, double limit) : numbers_(seed), limit_(limit) {}
  void prepare(const Scene&) override {}
  void reset() noexcept override {}
  void compute(const ToolState&, ContactBuffer&, RenderedForce& out) noexcept override {
    out = {};
    if (++rows_ < 3) return;
    out.spring = out.rendered = limit_ * numbers_.uniform() * numbers_.direction();
    moment_ = 0.01 * numbers_.uniform() * numbers_.direction();
  }
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return {0.0, moment_}; }
  ForceJacobian jacobian() const noexcept override { return {}; }

 private:
  Random numbers_;
  double limit_;
  int rows_ = 0;
  Vec3 moment_ = Vec3::Zero();
};

/// Motion whose tilt is random in 0 … 0.01 rad in each step. The rotation from step to step is at first 0.005 rad and
/// then -0.005 rad, which is a change of the rotation by 0.01 rad. Later, the rotation changes by at most 0.02 rad from
/// step to step. Therefore no change of the rotation exceeds twice the largest earlier change.
class Trembling final : public Motion {
 public:
  explicit Trembling(std::uint64_t seed) {
    Random numbers(seed);
    tilts_ = {0.0, 0.005, 0.0};
    while (tilts_.size() < 400) tilts_.push_back(0.01 * numbers.uniform());
  }
  Vec3 axis_at(double t) const noexcept override {
    const double tilt = tilts_[static_cast<std::size_t>(std::lround(t / SimulationConfig{}.dt))];
    return {std::sin(tilt), 0.0, -std::cos(tilt)};
  }
  bool position_is_free() const noexcept override { return true; }
  Vec3 position_at(double) const noexcept override { return Vec3::Zero(); }

 private:
  std::vector<double> tilts_;
};

TEST(PassivityController, KeepsAnyMomentOfATremblingHandPassive) {
  double smallest_without = 0.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    const auto ran = [&](bool controller) {
      SimulationParts parts = test::fake_parts(test::weightless);
      RenderingConfig config;
      config.max_force = seed % 2 == 0 ? 0.5 : 5.0;
      parts.algorithm = std::make_unique<Lever>(seed, *config.max_force);
      parts.motion = std::make_unique<Trembling>(seed);
      return run(test::thrown(400), controller ? controlled(std::move(parts), config) : std::move(parts));
    };
    const Ran held = ran(true);
    EXPECT_GE(held.watch.smallest, -held.watch.rounding());
    EXPECT_LE(held.watch.force_max, (seed % 2 == 0 ? 0.5 : 5.0) * (1.0 + 4.0 * kEpsilon));
    EXPECT_GT(held.controlled, 0u);
    smallest_without = std::min(smallest_without, ran(false).watch.smallest);
  }
  EXPECT_LT(smallest_without, -1e-3);
}

/// Checks that the controller changes a run with a fixed axis if and only if the run would create energy, because it
/// predicts the observed energy of the next step exactly.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): checks every step of each motion.
TEST(PassivityController, ChangesARunOnlyIfItWouldCreateEnergy) {
  std::size_t passive = 0, active = 0;
  for (const auto& algorithm : algorithms()) {
    for (const test::AnalyticScene& scene : test::analytic_scenes()) {
      for (const double damping_ratio : {0.0, 0.7}) {
        SCOPED_TRACE(std::string(scene.name) + " " + algorithm.info->name);
        RenderingConfig config = test::config_for(algorithm.info->name, scene);
        config.damping_ratio = damping_ratio;
        const test::Setting setting = scene.setting();
        const auto ran = [&](bool controller) {
          config.passivity_controller = controller;
          SimulationParts parts = test::free_run(setting, config);
          parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{0.5, -1.0, 1.5});
          return run(test::free_run_config(setting, config, 400), std::move(parts));
        };
        const Ran plain = ran(false), held = ran(true);
        EXPECT_GE(held.watch.smallest, -held.watch.rounding());
        if (plain.watch.smallest > plain.watch.rounding()) {
          EXPECT_EQ(held.controlled, 0u);
        }
        if (plain.watch.smallest < -plain.watch.rounding()) {
          EXPECT_GT(held.controlled, 0u);
        }
        (plain.watch.smallest < -plain.watch.rounding() ? active : passive) += 1;
        if (held.controlled == 0) {
          EXPECT_EQ(held.tool.pose.position, plain.tool.pose.position);
          EXPECT_EQ(held.tool.velocity, plain.tool.velocity);
        }
      }
    }
  }
  // Check that both cases have occurred.
  EXPECT_GT(passive, 10u);
  EXPECT_GT(active, 0u);
}

/// Checks the bound alpha <= M / dt of the damping alpha: the damping can stop the tool but cannot reverse its
/// velocity.
TEST(PassivityController, WithNothingToGiveItStopsTheToolAtMost) {
  SimulationConfig config = test::thrown(2);
  SimulationParts parts = controlled(test::fake_parts([](const ToolState& tool) { return Vec3(1e9 * tool.velocity); }));
  Simulation simulation(config, std::move(parts), {});
  const Vec3 before = simulation.tool().velocity;
  simulation.step();
  const Vec3 after = simulation.tool().velocity;
  // The controller may not return any energy. It therefore scales the new velocity to the previous speed, up to a few
  // roundings.
  EXPECT_NEAR(after.norm(), before.norm(), 10 * kEpsilon * before.norm());
  EXPECT_GT(after.dot(before), 0.0);
}

/// The controller renders s f - alpha w, where f is the force of the law and w the velocity. Checks that the Jacobian
/// of this force is s times the Jacobian of f, with alpha added to its damping. In this test, s = 0.
TEST(PassivityController, ItsJacobianIsThatOfTheForceItRenders) {
  RenderingConfig config;
  config.mass = 0.2;
  PassivityController controller(std::make_unique<test::FakeAlgorithm>([](const ToolState&) { return Vec3(9, 0, 0); }),
                                 config);
  const std::uint64_t row = 0;
  const Vec3 input = Vec3::Zero();
  controller.prepare({.dt = 0.0005, .row = &row, .input = &input});
  controller.reset();
  ContactBuffer none(0);
  RenderedForce out;
  controller.compute({}, none, out);  // at rest without stored energy: no force
  EXPECT_EQ(out.rendered, Vec3(0, 0, 0));
  EXPECT_EQ(controller.jacobian().stiffness, Mat3(Mat3::Zero()));
  EXPECT_EQ(controller.jacobian().damping, Mat3(0.2 / 0.0005 * Mat3::Identity()));
  // Other states within the step get the same scale and damping.
  ToolState moving;
  moving.velocity = {0, 1, 0};
  controller.compute(moving, none, out);
  EXPECT_EQ(out.rendered, Vec3(0, -0.2 / 0.0005, 0));
  EXPECT_EQ(controller.work().steps_controlled, 1u);
}

}  // namespace
}  // namespace hapbench::passivity_controller_test
