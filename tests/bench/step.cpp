#include "tests/bench/step.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "algorithms/registry.hpp"
#include "algorithms/shell_source.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/revolved.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"
#include "tests/support/meshes.hpp"

namespace hapbench::bench {

/// Writes the numbers of a row of trajectory.csv into memory that was there before.
class TimedRun::MemoryRecorder final : public Observer {
 public:
  explicit MemoryRecorder(std::size_t rows) : rows_(rows) {}

  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& r) noexcept override {
    rows_[r.step] = {r.time,   r.tool.pose, r.tool.velocity,    r.force.rendered,  r.force.spring, r.hand,
                     r.handle, r.colliding, r.rendered->size(), r.force.depth_max, r.ratio};
  }

 private:
  struct Row {
    double time = 0.0;
    ToolPose pose;
    Vec3 velocity;
    Vec3 rendered, spring;
    MeasuredForce hand;
    HandleState handle;
    std::size_t colliding = 0, kept = 0;
    double depth_max = 0.0;
    RatioRange ratio;
  };
  std::vector<Row> rows_;
};

namespace {

/// The mesh of the drill of all tasks, 128 sides and some 128^3 nodes.
std::shared_ptr<const SignedDistanceGrid> drill_grid(const Cylinder& drill) {
  static const auto grid = [&drill] {
    const TriangleSoup soup = test::cylinder_mesh(drill.radius(), drill.length(), 128);
    return test::grid_of(soup, SignedDistanceGrid::suggested_spacing(soup.vertices));
  }();
  return grid;
}

/// The drill with its side cut into eight lines, every other corner lowered by 0.1 um if it is to be grooved.
std::shared_ptr<const ToolShape> as_revolved(const Cylinder& drill, bool grooved) {
  std::vector<ProfilePoint> profile;
  for (int k = 0; k <= 8; ++k) {
    profile.push_back({drill.length() * (k - 8) / 8.0, drill.radius() - (grooved && k % 2 == 1 ? 1e-7 : 0.0)});
  }
  auto revolved = std::make_shared<Revolved>(std::move(profile), drill.tip());
  if (revolved->convex() == grooved) throw std::logic_error("the benchmark's tool is not what it is for");
  return revolved;
}

/// The drill in the shape that the end of a name in kSteps says; null for the drill as it is.
std::shared_ptr<const ToolShape> other_shape(const Cylinder& drill, const std::string& name) {
  if (name.ends_with("_mesh")) return std::make_shared<MeshTool>(drill_grid(drill));
  if (name.ends_with("_revolved")) return as_revolved(drill, false);
  if (name.ends_with("_grooved")) return as_revolved(drill, true);
  return nullptr;
}

SimulationParts parts_of(const Scenario& scenario, const std::string& name) {
  SimulationParts parts = assemble(scenario, block_shell(), {});
  const auto shape = other_shape(dynamic_cast<const Cylinder&>(*parts.tool), name);
  if (!shape) return parts;
  const RenderingConfig& rendering = scenario.rendering;
  parts.tool = shape;
  parts.source = std::make_unique<ShellSource>(*parts.shell, *parts.tool,
                                               make_contact_query(*parts.shell, *parts.tool, rendering.skips),
                                               make_depth_model(rendering), rendering.skips);
  return parts;
}

}  // namespace

TimedRun::TimedRun(const std::string& name, Skips skips) {
  Scenario scenario = step_scenario(name.substr(0, name.find("_revolved")).substr(0, name.find("_grooved"))).scenario;
  scenario.rendering.skips = skips;
  const SimulationConfig config = simulation_config(scenario);
  steps_ = config.steps;
  metrics_ = std::make_unique<MetricsObserver>(config.dt);
  passivity_ = std::make_unique<PassivityObserver>(config.dt);
  recorder_ = std::make_unique<MemoryRecorder>(steps_);
  simulation_ = std::make_unique<Simulation>(config, parts_of(scenario, name),
                                             std::vector<Observer*>{metrics_.get(), passivity_.get(), recorder_.get()});
}

TimedRun::~TimedRun() = default;

void TimedRun::rewind() noexcept {
  simulation_->reset();
  for (std::uint64_t k = 0; k < kWarmUp; ++k) simulation_->step();
}

std::string wrong_run(const std::string& name) {
  TimedRun run(name), reference(name, Skips::off);
  for (int k = 0; k < 2048; ++k) {
    run.simulation().step();
    reference.simulation().step();
  }
  const bool same = run.metrics().metrics().state_hash == reference.metrics().metrics().state_hash;
  return same ? "" : "not the run without skips";
}

namespace {

void step_benchmark(benchmark::State& state, const std::string& name) {
  if (!proved(state, "step/" + name, [&name] { return wrong_run(name); })) return;
  TimedRun run(name);
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(run.steps_left()))) {
    state.PauseTiming();
    run.rewind();
    state.ResumeTiming();
    while (run.simulation().step()) {
    }
    if (!run.at_end()) return refute(state, "ended early");
  }
  const Metrics metrics = run.metrics().metrics();
  const SearchWork& work = run.simulation().source().work();
  state.counters["contacts"] = metrics.colliding_mean;
  state.counters["points_tested"] = static_cast<double>(work.points_tested) / static_cast<double>(work.queries);
}

}  // namespace

void register_steps() {
  for (const char* name : kSteps) {
    benchmark::RegisterBenchmark(fmt::format("step/{}", name).c_str(), step_benchmark, std::string(name));
  }
}

}  // namespace hapbench::bench
