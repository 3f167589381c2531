#include "sim/loop/simulation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/tool_state.hpp"
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
  EXPECT_EQ(simulation.run().outcome, Outcome::completes);
  EXPECT_EQ(simulation.result().rows, 0u);
  EXPECT_TRUE(recorder.rows.empty());
  EXPECT_EQ(calls.compute, 0);
}

TEST(Simulation, RowKIsAtTimeKDtAndRowZeroIsTheInitialState) {
  Recorder recorder;
  SimulationConfig config = config_of(5000);
  config.dt = 1.0 / 3000.0;
  Simulation(config, fake_parts(spring), {&recorder}).run();
  // A product, not a sum of steps: no drift.
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
      views.push_back(view);
      return {t, 0, 0};
    }
    std::vector<HandView> views;
  };
  auto viewer = std::make_unique<Viewer>();
  const std::vector<HandView>& views = viewer->views;
  SimulationParts parts = fake_parts([](const ToolState& tool) { return Vec3(Vec3::Ones() - tool.pose.position); });
  parts.hand = std::move(viewer);
  Recorder recorder;
  Simulation simulation(config_of(10), std::move(parts), {&recorder});
  simulation.run();
  ASSERT_EQ(views.size(), 10u);
  EXPECT_EQ(views[0].model_force, Vec3(0, 0, 0));
  for (std::size_t k = 0; k < views.size(); ++k) {
    EXPECT_EQ(views[k].tool.position, recorder.rows[k].tool.pose.position);
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
    TargetTask task_{{.places = {Vec3(0, 0, 0)}, .targets_per_place = 2, .hold = 1.0}, 1};
  };
  SimulationParts parts = fake_parts(test::weightless);
  parts.hand = std::make_unique<Worker>();
  Recorder recorder;
  Simulation simulation(config_of(10), std::move(parts), {&recorder});  // owns the task that the rows name
  const SimulationResult result = simulation.run();
  EXPECT_EQ(result.outcome, Outcome::completes);
  EXPECT_EQ(result.rows, 4u) << "two targets, two samples each";
  EXPECT_EQ(recorder.rows.back().task->results().size(), 2u);
}

TEST(Simulation, TheRatioIsComputedExactlyWhenAnObserverWantsIt) {
  // FakeAlgorithm answers S = 2 I, so every ratio is 2.
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

/// The thesis's 2-D peg, where everything a run is made of takes part.
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

  // Also from the middle of a run.
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
  // The second run of the same object must not remember the first.
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
    const std::size_t to = std::max<std::size_t>(k, 1);  // row 0 has the velocity of row 1
    const Vec3 moved = rows[to].tool.pose.position - rows[to - 1].tool.pose.position;
    EXPECT_EQ(rows[k].tool.velocity, Vec3(moved / SimulationConfig{}.dt));
    EXPECT_EQ(rows[k].handle.position, position);
    EXPECT_EQ(rows[k].handle.velocity, rows[k].tool.velocity);
  }
}

// The tool's turn about its own axis.

const double kDt = SimulationConfig{}.dt;

Profile ramp(double start, double rate) {
  return Profile::Shape(Profile::Ramp{start, rate});
}

const Orientation kSpun{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), ramp(0.5, 30.0)};
const Orientation kLed{{0, 0, 1}, {1, 0, 0}, ramp(0.3, 2.0), ramp(-1.0, 5.0), 0.5};

/// Independent of axis and roll.
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

/// Reads the angular velocity, unfiltered, and answers nothing.
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
/// It is not round.
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

/// Turns of 1e-3 rad are known to 1e-16 / 1e-3.
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

}  // namespace
}  // namespace hapbench::simulation_test
