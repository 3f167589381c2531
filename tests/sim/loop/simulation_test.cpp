#include "sim/loop/simulation.hpp"

#include <gtest/gtest.h>

#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/leapfrog.hpp"

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

TEST(Simulation, RowsAreAsManyAsSteps) {
  for (const std::uint64_t steps : {1u, 2u, 17u}) {
    Recorder recorder;
    Simulation simulation(config_of(steps), fake_parts(spring), {&recorder});
    const SimulationResult result = simulation.run();
    EXPECT_EQ(result.outcome, Outcome::completes);
    EXPECT_EQ(result.rows, steps);
    EXPECT_EQ(recorder.rows.size(), steps);
    EXPECT_FALSE(simulation.step());
    EXPECT_EQ(recorder.rows.size(), steps);
  }
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

TEST(Simulation, RowKIsAtTimeKDt) {
  Recorder recorder;
  SimulationConfig config = config_of(5000);
  config.dt = 1.0 / 3000.0;
  Simulation(config, fake_parts(spring), {&recorder}).run();
  // A product, not a sum of steps: no drift.
  for (std::size_t k = 0; k < recorder.rows.size(); ++k) {
    EXPECT_EQ(recorder.rows[k].step, k);
    EXPECT_EQ(recorder.rows[k].time, static_cast<double>(k) * config.dt);
  }
}

TEST(Simulation, RowZeroIsTheInitialState) {
  Recorder recorder;
  const SimulationConfig config = config_of(1);
  Simulation(config, fake_parts(spring), {&recorder}).run();
  EXPECT_EQ(recorder.rows[0].tool.pose.position, config.position);
  EXPECT_EQ(recorder.rows[0].tool.velocity, config.velocity);
  EXPECT_EQ(recorder.rows[0].tool.pose.axis, Vec3(0, 0, -1));
}

TEST(Simulation, EachRowIsEvaluatedBeforeItsStepIsTaken) {
  Recorder recorder;
  const SimulationConfig config = config_of(100);
  Simulation(config, fake_parts(spring), {&recorder}).run();
  ToolState tool = recorder.rows[0].tool;
  for (const StepRecord& row : recorder.rows) {
    EXPECT_EQ(row.tool.pose.position, tool.pose.position);
    EXPECT_EQ(row.tool.velocity, tool.velocity);
    EXPECT_EQ(row.force.rendered, spring(tool));
    test::leapfrog(tool, row.force.rendered, config.mass, config.dt);
  }
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

TEST(Simulation, TheHandFeelsTheHandleOfTheSameRow) {
  struct Spring final : Hand {
    void reset() noexcept override {}
    Vec3 force(double t, const HandView& view) noexcept override {
      return t * view.handle.position + view.handle.velocity;
    }
  };
  SimulationParts parts = fake_parts(test::weightless);
  parts.hand = std::make_unique<Spring>();
  Recorder recorder;
  Simulation(config_of(10), std::move(parts), {&recorder}).run();
  for (const StepRecord& row : recorder.rows) {
    EXPECT_EQ(row.handle.position, row.tool.pose.position);
    EXPECT_EQ(row.handle.velocity, row.tool.velocity);
    EXPECT_EQ(row.hand.measured, Vec3(row.time * row.handle.position + row.handle.velocity));
  }
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
      task_.advance({0, 0, 0}, 2.0, 0.5);
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

/// Notes the order in which observers see rows.
class Note final : public Observer {
 public:
  Note(int id, std::vector<int>& notes) : id_(id), notes_(&notes) {}
  void on_step(const StepRecord&) noexcept override { notes_->push_back(id_); }

 private:
  int id_;
  std::vector<int>* notes_;
};

TEST(Simulation, ObserversAreCalledInTheirOrderOnEveryRow) {
  std::vector<int> notes;
  Note first(1, notes), second(2, notes), third(3, notes);
  Simulation(config_of(3), fake_parts(spring), {&second, &first, &third}).run();
  EXPECT_EQ(notes, (std::vector<int>{2, 1, 3, 2, 1, 3, 2, 1, 3}));
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

TEST(Simulation, RowsTellCollidingAndRenderedContacts) {
  SimulationParts parts = fake_parts(test::weightless);
  parts.source = std::make_unique<test::FakeSource>(3);
  Recorder recorder;
  Simulation(config_of(1), std::move(parts), {&recorder}).run();
  EXPECT_EQ(recorder.rows[0].colliding, 3u);
  EXPECT_EQ(recorder.rendered[0], 3u);
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

TEST(Simulation, SteppingIsRunning) {
  Recorder stepped, ran;
  Simulation a(config_of(20), fake_parts(spring), {&stepped}), b(config_of(20), fake_parts(spring), {&ran});
  std::uint64_t row = 0;
  do {
    EXPECT_EQ(a.next_row(), row++);
  } while (row < 20 && a.step());
  while (a.step()) {
  }
  b.run();
  ASSERT_EQ(stepped.rows.size(), ran.rows.size());
  EXPECT_EQ(stepped.rows.back().tool.pose.position, ran.rows.back().tool.pose.position);
}

}  // namespace
}  // namespace hapbench::simulation_test
