#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/loop/observed_energy.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/motion.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::simulation_test {
namespace {

using test::Calls;
using test::fake_parts;
using test::Recorder;

Vec3 spring(const ToolState& tool) {
  return -20000.0 * tool.pose.position - 50.0 * tool.velocity;
}

SimulationConfig config_of(std::uint64_t steps) {
  SimulationConfig config;
  config.steps = steps;
  config.position = {0.001, 0.002, 0.003};
  config.velocity = {0.1, 0.0, -0.1};
  return config;
}

TEST(Simulation, OfNoStepsCompletesWithoutARow) {
  Recorder recorder;
  Calls calls;
  Simulation simulation(config_of(0), fake_parts(spring, &calls), {&recorder});
  EXPECT_FALSE(simulation.step());
  EXPECT_EQ(simulation.run().ending, Ending::completed);
  EXPECT_EQ(simulation.result().rows, 0u);
  EXPECT_TRUE(recorder.rows.empty());
  EXPECT_EQ(calls.compute, 0);
}

TEST(Simulation, RowKIsAtTimeKDtAndRowZeroIsTheInitialState) {
  Recorder recorder;
  SimulationConfig config = config_of(5000);
  config.dt = 1.0 / 3000.0;
  Simulation(config, fake_parts(spring), {&recorder}).run();
  // The time is a product, not a sum of steps, so it does not drift.
  for (std::size_t k = 0; k < recorder.rows.size(); ++k) {
    EXPECT_EQ(recorder.rows[k].step, k);
    EXPECT_EQ(recorder.rows[k].time, static_cast<double>(k) * config.dt);
  }
  EXPECT_EQ(recorder.rows[0].tool.pose.position, config.position);
  EXPECT_EQ(recorder.rows[0].tool.velocity, config.velocity);
  EXPECT_EQ(recorder.rows[0].tool.pose.axis, Vec3(0, 0, -1));
}

TEST(Simulation, TheLimitedHandForceDrivesTheTool) {
  SimulationParts parts = fake_parts(test::weightless);
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{3.0, 0.0, Profile::Shape(Profile::Ramp{-4.0, 0.0})});
  parts.device = std::make_unique<IdealDevice>(2.0);
  Recorder recorder;
  const SimulationConfig config = config_of(2);
  Simulation(config, std::move(parts), {&recorder}).run();
  EXPECT_EQ(recorder.rows[0].hand.measured, Vec3(3, 0, -4));
  EXPECT_EQ(recorder.rows[0].hand.input, Vec3(3, 0, -4) * (2.0 / 5.0));
  ToolState tool = recorder.rows[0].tool;
  test::leapfrog(tool, recorder.rows[0].hand.input, config.mass, config.dt);
  EXPECT_EQ(recorder.rows[1].tool.velocity, tool.velocity);
}

TEST(Simulation, TheHandSeesTheToolOfItsRowAndTheForceOfTheRowBefore) {
  struct Viewer final : Hand {
    void reset() noexcept override {}
    Vec3 force(double t, const HandView& view) noexcept override {
      views.push_back({view.tool.position, view.model_force});
      return {t, 0, 0};
    }
    struct View {
      Vec3 tool_position, model_force;
    };
    std::vector<View> views;
  };
  auto viewer = std::make_unique<Viewer>();
  const std::vector<Viewer::View>& views = viewer->views;
  SimulationParts parts = fake_parts([](const ToolState& tool) { return Vec3(Vec3::Ones() - tool.pose.position); });
  parts.hand = std::move(viewer);
  Recorder recorder;
  Simulation simulation(config_of(10), std::move(parts), {&recorder});
  simulation.run();
  ASSERT_EQ(views.size(), 10u);
  EXPECT_EQ(views[0].model_force, Vec3(0, 0, 0));
  for (std::size_t k = 0; k < views.size(); ++k) {
    EXPECT_EQ(views[k].tool_position, recorder.rows[k].tool.pose.position);
    EXPECT_EQ(recorder.rows[k].hand_force, Vec3(recorder.rows[k].time, 0, 0));
    if (k == 0) continue;
    EXPECT_EQ(views[k].model_force, recorder.rows[k - 1].force.rendered);
  }
  simulation.reset();
  simulation.step();
  EXPECT_EQ(views.back().model_force, Vec3(0, 0, 0)) << "a reset forgets the last force";
}

TEST(Simulation, EndsWithTheRowInWhichTheHandHasFinishedItsTask) {
  struct Worker final : Hand {
    void reset() noexcept override { task_.reset(); }
    Vec3 force(double, const HandView&) noexcept override {
      task_.advance({0, 0, 0}, 2.0, 2.0, 0.5);
      return {0, 0, 0};
    }
    const TargetTask* task() const noexcept override { return &task_; }
    TargetTask task_{{.positions = {Vec3(0, 0, 0)}, .targets_per_position = 2, .hold = 1.0}, 1};
  };
  SimulationParts parts = fake_parts(test::weightless);
  parts.hand = std::make_unique<Worker>();
  Recorder recorder;
  Simulation simulation(config_of(10), std::move(parts),
                        {&recorder});  // the simulation owns the task to which the records point
  const SimulationResult result = simulation.run();
  EXPECT_EQ(result.ending, Ending::completed);
  EXPECT_EQ(result.rows, 4u) << "two targets, two samples each";
  EXPECT_EQ(recorder.rows.back().task->results().size(), 2u);
}

TEST(Simulation, TheRatioIsComputedExactlyWhenAnObserverWantsIt) {
  // FakeAlgorithm returns S = 2 I, so every ratio is 2.
  for (const bool wanted : {false, true}) {
    SimulationParts parts = fake_parts(test::weightless);
    parts.source = std::make_unique<test::FakeSource>(3);
    Recorder one(false), other(wanted);
    Simulation(config_of(2), std::move(parts), {&one, &other}).run();
    for (const Recorder* recorder : {&one, &other}) {
      EXPECT_EQ(recorder->rows[1].ratio.min, wanted ? 2.0 : 0.0);
      EXPECT_EQ(recorder->rows[1].ratio.max, wanted ? 2.0 : 0.0);
    }
  }
}

TEST(Simulation, PreparesItsAlgorithmOnceAndComputesOncePerRow) {
  Calls calls;
  Simulation simulation(config_of(5), fake_parts(spring, &calls), {});
  simulation.run();
  EXPECT_EQ(calls.prepare, 1);
  EXPECT_EQ(calls.compute, 5);
  const int resets = calls.reset;
  EXPECT_GE(resets, 1);
  simulation.reset();
  EXPECT_EQ(calls.prepare, 1);
  EXPECT_EQ(calls.reset, resets + 1);
}

/// Returns the parts of a run of the thesis's 2-D peg, in which all kinds of parts occur.
SimulationParts peg(const RenderingConfig& rendering) {
  test::Setting setting;
  setting.tool = {0.0005, 0.005, Tip::round};
  setting.points = surface_points(Hole2d{});
  SimulationParts parts = test::free_run(setting, rendering);
  parts.motion = std::make_unique<ScriptedMotion>(
      Orientation{{0, 1, 0}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), {}}, std::nullopt);
  return parts;
}

TEST(Simulation, ResetReproducesTheRunBitForBit) {
  RenderingConfig rendering;
  rendering.reduction = ReductionConfig{0.995, 100, 7};
  SimulationConfig config;
  config.steps = 1000;
  config.position = {0, -0.004, 0};
  test::HashingObserver hash;
  Simulation simulation(config, peg(rendering), {&hash});
  simulation.run();
  const std::uint64_t first = hash.value(), queries = simulation.source().work().queries,
                      iterations = simulation.algorithm().work().iterations;

  // A reset from the middle of a run also restarts it.
  for (const int interrupted_after : {0, 1, 500}) {
    simulation.reset();
    for (int k = 0; k < interrupted_after; ++k) simulation.step();
    hash.clear();
    simulation.reset();
    EXPECT_EQ(simulation.next_row(), 0u);
    EXPECT_EQ(simulation.result().rows, 0u);
    EXPECT_EQ(simulation.run().rows, config.steps);
    EXPECT_EQ(hash.value(), first);
    EXPECT_EQ(simulation.source().work().queries, queries);
    EXPECT_EQ(simulation.algorithm().work().iterations, iterations);
  }
}

std::array<Profile, 3> some_path() {
  return {Profile::Shape(Profile::Sine{0.001, 0.002, 0.1, 0.3}), Profile::Shape(Profile::Ramp{0.5, -2.0}), 0.25};
}

std::vector<StepRecord> run_along(std::array<Profile, 3> path, test::FakeAlgorithm::Law law) {
  SimulationParts parts = fake_parts(std::move(law));
  parts.motion = std::make_unique<ScriptedMotion>(Orientation{}, std::move(path));
  SimulationConfig config;
  config.steps = 200;
  config.position = {7, 7, 7};
  config.velocity = {3, 3, 3};
  Recorder recorder;
  Simulation simulation(config, std::move(parts), {&recorder});
  simulation.run();
  // The second run of the same object must not depend on the first run.
  simulation.reset();
  recorder.rows.clear();
  simulation.run();
  return recorder.rows;
}

TEST(PrescribedMotion, PutsToolAndHandleWhereTheScriptSaysWithTheBackwardDifferenceAsVelocity) {
  const auto path = some_path();
  const auto rows = run_along(path, test::weightless);
  ASSERT_EQ(rows.size(), 200u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& [position, axis, roll] = rows[k].tool.pose;
    EXPECT_EQ(position, Vec3(path[0](rows[k].time), path[1](rows[k].time), path[2](rows[k].time)));
    const std::size_t to =
        std::max<std::size_t>(k, 1);  // step 0 has the velocity of step 1, because it has no previous step
    const Vec3 moved = rows[to].tool.pose.position - rows[to - 1].tool.pose.position;
    EXPECT_EQ(rows[k].tool.velocity, Vec3(moved / SimulationConfig{}.dt));
    EXPECT_EQ(rows[k].handle.position, position);
    EXPECT_EQ(rows[k].handle.velocity, rows[k].tool.velocity);
  }
}

// Tests the rotation of the tool about its own axis.

const double kDt = SimulationConfig{}.dt;

Profile ramp(double start, double rate) {
  return Profile::Shape(Profile::Ramp{start, rate});
}

const Orientation kSpun{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), ramp(0.5, 30.0)};
const Orientation kLed{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), 0.5};

/// Returns the rotation of the tool at the time t, computed independently of axis and roll.
Mat3 rotation(const Orientation& o, double t) {
  return (Eigen::AngleAxisd(o.azimuth(t), Vec3::UnitZ()) * Eigen::AngleAxisd(o.tilt(t), Vec3::UnitY()) *
          Eigen::AngleAxisd(o.roll(t), -Vec3::UnitZ()))
      .toRotationMatrix();
}

class WantsRoll final : public Observer {
 public:
  bool wants_roll() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override { rows.push_back(record); }
  std::vector<StepRecord> rows;
};

/// Algorithm that requests the angular velocity without a filter, and renders no force.
class ReadsTurn final : public ForceAlgorithm {
 public:
  void prepare(const Scene&) override {}
  void reset() noexcept override {}
  void compute(const ToolState&, ContactBuffer&, RenderedForce& out) noexcept override { out = {}; }
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return {}; }
  ForceJacobian jacobian() const noexcept override { return {}; }
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return std::numeric_limits<double>::infinity();
  }
};

std::vector<StepRecord> rows_of(std::shared_ptr<const ToolShape> tool, const Orientation& orientation) {
  SimulationParts parts = test::fake_parts(test::weightless);
  parts.tool = std::move(tool);
  parts.algorithm = std::make_unique<ReadsTurn>();
  parts.motion = std::make_unique<ScriptedMotion>(orientation, std::nullopt);
  SimulationConfig config;
  config.steps = 5;
  WantsRoll observer;
  Simulation(config, std::move(parts), {&observer}).run();
  return observer.rows;
}

const auto kCylinder = std::make_shared<const Cylinder>();
/// Returns a tool that is not a solid of revolution.
std::shared_ptr<const ToolShape> cube() {
  return std::make_shared<const MeshTool>(test::grid_of(test::cube(0.0005), 0.0001));
}

TEST(Roll, IsRecordedOfEveryToolAndInThePoseOfThoseThatAreNotRound) {
  for (const StepRecord& row : rows_of(kCylinder, kSpun)) {
    EXPECT_LE((ToolPose{Vec3::Zero(), row.tool.pose.axis, row.roll}.rotation() - rotation(kSpun, row.time)).norm(),
              1e-14);
    EXPECT_EQ(row.tool.pose.roll, 0.0);
  }
  for (const StepRecord& row : rows_of(cube(), kSpun)) {
    EXPECT_LE((row.tool.pose.rotation() - rotation(kSpun, row.time)).norm(), 1e-14);
    EXPECT_EQ(row.tool.pose.roll, row.roll);
  }
}

/// Checks the angular velocity. For a rotation by 1e-3 rad, it has a relative error of 1e-16 / 1e-3.
TEST(Roll, IsInTheAngularVelocityWhereItIsScriptedOrTheToolIsNotRound) {
  const auto expect_whole = [](const std::vector<StepRecord>& rows, const Orientation& script) {
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const Eigen::AngleAxisd turned(
          Mat3(rotation(script, rows[k].time) * rotation(script, rows[k - 1].time).transpose()));
      EXPECT_LE((rows[k].tool.angular_velocity - turned.angle() / kDt * turned.axis()).norm(), 1e-10) << k;
    }
  };
  expect_whole(rows_of(kCylinder, kSpun), kSpun);
  expect_whole(rows_of(cube(), kSpun), kSpun);
  expect_whole(rows_of(cube(), kLed), kLed);
  const auto led = rows_of(kCylinder, kLed);
  for (std::size_t k = 1; k < led.size(); ++k) {
    EXPECT_EQ(led[k].tool.angular_velocity, Vec3(turn(led[k - 1].tool.pose.axis, led[k].tool.pose.axis) / kDt));
  }
}

/// Returns the configuration of a run in which the tool rises at 1 m/s along `up`, from 10.5 steps below height 0.
SimulationConfig rising(const Vec3& up) {
  SimulationConfig config;
  config.steps = 100;
  config.velocity = up;
  config.position = -10.5 * config.dt * up;
  return config;
}

SimulationResult run(const SimulationConfig& config, SimulationParts parts, Recorder& recorder) {
  return Simulation(config, std::move(parts), {&recorder}).run();
}

TEST(StopConditions, LeavesTheHoleAtTheFirstRowAboveHeightZeroWhichIsRecorded) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    SimulationConfig config = rising(up);
    config.stop_when = {{Ending::left_hole, up}};
    // At step 11 the tool is half a step above height 0. If step 11 is the last step, the run still ends by the stop
    // condition.
    for (const std::uint64_t steps : {100u, 12u}) {
      config.steps = steps;
      Recorder recorder;
      const SimulationResult result = run(config, fake_parts(test::weightless), recorder);
      EXPECT_EQ(result.ending, Ending::left_hole);
      EXPECT_EQ(result.rows, 12u);
      ASSERT_EQ(recorder.rows.size(), 12u);
      EXPECT_GT(recorder.rows[11].tool.pose.position.dot(up), 0.0);
      EXPECT_LT(recorder.rows[10].tool.pose.position.dot(up), 0.0);
    }
  }
}

SimulationParts tilting(const Vec3& up, double start, double rate_per_s) {
  SimulationParts parts = fake_parts(test::weightless);
  parts.motion = std::make_unique<ScriptedMotion>(
      Orientation{up, {1, 0, 0}, Profile::Shape(Profile::Ramp{start, rate_per_s}), {}}, std::nullopt);
  return parts;
}

TEST(StopConditions, ToolIsHorizontalAtTheFirstRowWhereItsAxisReachesThePlaneWhichIsRecorded) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    SimulationConfig config;
    config.steps = 10000;
    config.stop_when = {{Ending::tool_horizontal, up}};
    Recorder recorder;
    const SimulationResult result = Simulation(config, tilting(up, 0.1, 1.2), {&recorder}).run();
    EXPECT_EQ(result.ending, Ending::tool_horizontal);
    // The tool is horizontal when 0.1 + 1.2 k dt = pi / 2.
    const double k = std::ceil((std::numbers::pi / 2 - 0.1) / 1.2 / config.dt);
    EXPECT_EQ(static_cast<double>(result.rows), k + 1);
    ASSERT_EQ(recorder.rows.size(), result.rows);
    EXPECT_GE(recorder.rows.back().tool.pose.axis.dot(up), 0.0);
    EXPECT_LT(recorder.rows[recorder.rows.size() - 2].tool.pose.axis.dot(up), 0.0);
  }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

SimulationConfig at_rest(std::uint64_t steps) {
  SimulationConfig config;
  config.steps = steps;
  return config;
}

/// Returns a law without force for the first `steps` calls, then with the given force.
test::FakeAlgorithm::Law after(int steps, const Vec3& force) {
  return [=, k = 0](const ToolState&) mutable { return k++ < steps ? Vec3(Vec3::Zero()) : force; };
}

TEST(Divergence, StopsAtTheRowWhoseForceIsNotFiniteAndKeepsTheRowsBefore) {
  for (const double bad : {kNaN, kInf, -kInf}) {
    Recorder recorder;
    Simulation simulation(at_rest(100), fake_parts(after(5, {0, bad, 0})), {&recorder});
    const SimulationResult result = simulation.run();
    EXPECT_EQ(result.ending, Ending::diverged);
    EXPECT_EQ(result.rows, 5u);
    ASSERT_EQ(recorder.rows.size(), 5u);
    for (const StepRecord& row : recorder.rows) EXPECT_TRUE(row.force.rendered.allFinite());
    EXPECT_EQ(result.divergence.step, 5u);
    EXPECT_EQ(result.divergence.time, 5 * SimulationConfig{}.dt);
    EXPECT_EQ(result.divergence.quantity, std::string("rendered force"));
    EXPECT_FALSE(std::isfinite(result.divergence.magnitude));
    EXPECT_EQ(result.divergence.bound, DivergenceBounds{}.force);
    EXPECT_FALSE(simulation.step());
  }
}

TEST(Divergence, IsReportedForEachQuantityThatLeavesItsBound) {
  const struct {
    Vec3 velocity;
    double force;
    const char* quantity;
    std::uint64_t step;
    double magnitude, bound;
  } kCases[] = {{{0, 0, 3}, 0.0, "position", 2, 0.75, 0.5},  // 0.375 m per step
                {{0, 0, 5}, 0.0, "velocity", 0, 5.0, 4.0},
                {{0, 0, 0}, 17.0, "rendered force", 0, 17.0, 16.0}};
  for (const auto& c : kCases) {
    SimulationConfig config = at_rest(100);
    config.bounds = {0.5, 4.0, 16.0};
    config.dt = 0.125;
    config.velocity = c.velocity;
    Recorder recorder;
    const SimulationResult result = run(config, fake_parts(after(0, {0, 0, c.force})), recorder);
    EXPECT_EQ(recorder.rows.size(), result.rows);
    EXPECT_EQ(result.rows, c.step);
    EXPECT_EQ(result.divergence.step, c.step);
    EXPECT_EQ(result.divergence.quantity, std::string(c.quantity));
    EXPECT_EQ(result.divergence.magnitude, c.magnitude);
    EXPECT_EQ(result.divergence.bound, c.bound);
  }
}

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kStep = 0.001, kMass = 0.2, kK = 5000.0;

/// Simulates one spring-damper along x under leapfrog, observed for `rows` steps; returns the final state of the tool.
ToolState run_spring(ObservedEnergy& observed, double damping, double position, double velocity, int rows) {
  ToolState tool{{{position, 0, 0}, {0, 0, -1}}, {velocity, 0, 0}};
  for (int k = 0; k < rows; ++k) {
    const double x = tool.pose.position.x();
    observed.move(tool);
    const Vec3 force{-kK * x - damping * tool.velocity.x(), 0, 0};
    observed.answer(tool, force, {0.5 * kK * x * x, Vec3::Zero()});
    if (k + 1 < rows) test::leapfrog(tool, force, kMass, kStep);
  }
  return tool;
}

/// Checks the definition of the observed energy E_n after n steps. Work is the kinetic energy that the force adds to
/// the tool, so that E_n - E_0 is the energy that the tool has lost.
TEST(ObservedEnergy, IsWhatALoneToolHasLost) {
  ObservedEnergy observed(kStep);
  const ToolState end = run_spring(observed, 20.0, 0.003, 0.4, 300);
  const double given = 0.5 * kK * 0.003 * 0.003 + 0.5 * kMass * 0.4 * 0.4;
  EXPECT_NEAR(observed.energy(), given - 0.5 * kMass * end.velocity.squaredNorm(), 300 * 10 * kEpsilon * given);
}

/// Checks the trapezoidal rule: the work of a rotation between two steps is the rotation times the mean of the moments
/// at both steps.
TEST(ObservedEnergy, AMomentThatAppearsOrGoesCountsForHalfATurn) {
  ObservedEnergy observed(kStep);
  double angle = 0.0;
  const auto row = [&](double moment) {
    ToolState tool;
    tool.pose.axis = {std::sin(angle), 0, -std::cos(angle)};
    observed.move(tool);
    observed.answer(tool, Vec3::Zero(), {0.0, {0, moment, 0}});
    angle += 0.1;
  };
  row(0.0);
  row(0.0);
  EXPECT_EQ(observed.energy(), 0.0);
  row(4.0);
  EXPECT_NEAR(observed.energy(), 0.2, 1e-15);
  row(0.0);
  EXPECT_NEAR(observed.energy(), 0.4, 1e-15);
  row(0.0);
  EXPECT_NEAR(observed.energy(), 0.4, 1e-15);
}

/// Checks the shortcut rest() for steps without force and moment against the full computation. After such steps, the
/// work of a moment must use the rotation since the previous step.
TEST(ObservedEnergy, ARowOfRestIsARowWithoutForceAndMoment) {
  ObservedEnergy resting(kStep), asked(kStep);
  for (int k = 0; k < 30; ++k) {
    ToolState tool{{Vec3::Zero(), {std::sin(0.1 * k), 0, -std::cos(0.1 * k)}}, {1.0, 0.1 * k, 0}};
    const bool acts = k % 7 == 3 || k % 7 == 4;
    const Vec3 force = acts ? Vec3(2, 1, 0) : Vec3(0, 0, 0);
    const SpringState springs{0.0, acts ? Vec3(0, 1.0 + k, 0) : Vec3(0, 0, 0)};
    EXPECT_EQ(resting.rests(force, springs), k != 0 && !acts && k % 7 != 5);
    if (resting.rests(force, springs)) {
      resting.rest(tool);
    } else {
      resting.move(tool);
      resting.answer(tool, force, springs);
    }
    asked.move(tool);
    asked.answer(tool, force, springs);
    EXPECT_EQ(resting.energy(), asked.energy());
  }
}

TEST(ObservedEnergy, ResetForgetsEverything) {
  ObservedEnergy observed(kStep), fresh(kStep);
  run_spring(observed, 3.0, 0.01, -0.2, 50);
  observed.reset();
  run_spring(observed, 1.0, 0.002, 0.1, 50);
  run_spring(fresh, 1.0, 0.002, 0.1, 50);
  EXPECT_EQ(observed.energy(), fresh.energy());
}

}  // namespace
}  // namespace hapbench::simulation_test
