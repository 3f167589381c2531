#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/metrics.hpp"
#include "results/observe/step_times.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/revolved.hpp"
#include "tests/bench/bench.hpp"
#include "tests/results/observing.hpp"
#include "tests/support/meshes.hpp"

/// Times whole steps: mean time, single steps, growth with the number of contacts, and the time that each skip saves.
namespace hapbench::bench {
namespace {

/// Names of the runs whose steps are timed.
constexpr const char* kSteps[] = {"T1",
                                  "T2",
                                  "T2_proxy",
                                  "T3",
                                  "T1_revolved",
                                  "T2_revolved",
                                  "T3_revolved",
                                  "T3_grooved",
                                  "T1_mesh",
                                  "T2_mesh",
                                  "T3_mesh",
                                  "unreduced_1000",
                                  "free_air",
                                  "upright",
                                  "upright_proxy",
                                  "pressed_ideal",
                                  "pressed_impedance"};

/// Number of steps before the first timed step. By then T1 has touched the block, and every buffer has been used.
constexpr std::uint64_t kWarmUp = 1024;

/// Returns the grid of the drill of all tasks: a mesh with 128 sides, and some 128^3 nodes.
std::shared_ptr<const SignedDistanceGrid> drill_grid(const Cylinder& drill) {
  static const auto grid = [&drill] {
    const TriangleSoup soup = test::cylinder_mesh(drill.radius(), drill.length(), 128);
    return test::grid_of(soup, SignedDistanceGrid::suggested_spacing(soup.vertices));
  }();
  return grid;
}

/// Returns the drill as a solid of revolution whose profile consists of eight line segments along the side. If
/// `grooved` is true, the radius is reduced by 0.1 um at every other vertex of the profile.
std::shared_ptr<const ToolShape> as_revolved(const Cylinder& drill, bool grooved) {
  std::vector<ProfilePoint> profile;
  for (int k = 0; k <= 8; ++k) {
    profile.push_back({drill.length() * (k - 8) / 8.0, drill.radius() - (grooved && k % 2 == 1 ? 1e-7 : 0.0)});
  }
  auto revolved = std::make_shared<Revolved>(std::move(profile), drill.tip());
  if (revolved->convex() == grooved) throw std::logic_error("the benchmark's tool is not what it is for");
  return revolved;
}

/// Returns the shape of the drill that the suffix of a name in kSteps selects; null for the drill of the scenario.
std::shared_ptr<const ToolShape> other_shape(const Cylinder& drill, const std::string& name) {
  if (name.ends_with("_mesh")) return std::make_shared<MeshTool>(drill_grid(drill));
  if (name.ends_with("_revolved")) return as_revolved(drill, false);
  if (name.ends_with("_grooved")) return as_revolved(drill, true);
  return nullptr;
}

SimulationParts parts_of(const Scenario& scenario, const std::string& name) {
  SimulationParts parts = assemble(scenario, NamedFiles(scenario), block_shell(), {});
  const auto shape = other_shape(dynamic_cast<const Cylinder&>(*parts.tool), name);
  if (!shape) return parts;
  const RenderingConfig& rendering = scenario.rendering;
  parts.tool = shape;
  parts.source = std::make_unique<ShellSource>(*parts.shell, *parts.tool,
                                               make_contact_query(*parts.shell, *parts.tool, rendering.skips),
                                               make_depth_model(rendering), rendering.skips);
  return parts;
}

/// Writes the numbers of a line of trajectory.csv into preallocated memory.
class MemoryRecorder final : public Observer {
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

/// A simulation with the observers of every `hapbench run`, and optionally a recorder.
struct WatchedRun {
  MetricsObserver metrics;
  PassivityObserver passivity;
  Simulation simulation;

  WatchedRun(const SimulationConfig& config, SimulationParts parts, Observer* recorder)
      : metrics(config.dt), passivity(config.dt), simulation(config, std::move(parts), observers(recorder)) {}

 private:
  std::vector<Observer*> observers(Observer* recorder) {
    if (recorder == nullptr) return {&metrics, &passivity};
    return {&metrics, &passivity, recorder};
  }
};

/// Returns the scenario of one of kSteps. In `_revolved` the drill is described as a solid of revolution whose side is
/// divided into eight lines; the shape of its body is the same. In `_grooved` the drill has grooves of 0.1 um, so that
/// it is not convex but touches nearly the same points.
Scenario scenario_of(const std::string& name, Skips skips) {
  Scenario scenario = step_scenario(name.substr(0, name.find("_revolved")).substr(0, name.find("_grooved"))).scenario;
  scenario.rendering.skips = skips;
  return scenario;
}

/// A run of one of kSteps as in `hapbench run`, with a recorder that keeps the numbers of trajectory.csv in memory.
class TimedRun {
 public:
  explicit TimedRun(const std::string& name, Skips skips = Skips::on) : TimedRun(name, scenario_of(name, skips)) {}

  /// Returns to the state after kWarmUp steps.
  void rewind() noexcept {
    simulation().reset();
    for (std::uint64_t k = 0; k < kWarmUp; ++k) simulation().step();
  }
  /// Returns the number of steps from the rewound state to the end of the run.
  std::uint64_t steps_left() const { return steps_ - kWarmUp; }
  /// Returns true if every step has been taken.
  bool at_end() const { return run_.simulation.next_row() == steps_; }
  Simulation& simulation() { return run_.simulation; }
  const MetricsObserver& metrics() const { return run_.metrics; }

 private:
  TimedRun(const std::string& name, const Scenario& scenario)
      : steps_(simulation_config(scenario).steps),
        recorder_(steps_),
        run_(simulation_config(scenario), parts_of(scenario, name), &recorder_) {}

  std::uint64_t steps_;
  MemoryRecorder recorder_;
  WatchedRun run_;
};

/// Compares the first second of the run with the run without skips (brute force, everything computed). Position,
/// velocity and force of every step must be identical. Returns a description of the error; empty if all steps are
/// identical.
std::string wrong_run(const std::string& name) {
  TimedRun run(name), reference(name, Skips::off);
  for (int k = 0; k < 2048; ++k) {
    run.simulation().step();
    reference.simulation().step();
  }
  const bool same = run.metrics().state_hash() == reference.metrics().state_hash();
  return same ? "" : "not the run without skips";
}

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
  const SearchWork& work = run.simulation().source().work();
  state.counters["contacts"] = reported(run.metrics(), "colliding_mean").value_or(0.0);
  state.counters["points_tested"] = static_cast<double>(work.points_tested) / static_cast<double>(work.queries);
}

void add_steps() {
  for (const char* name : kSteps) {
    benchmark::RegisterBenchmark(fmt::format("step/{}", name).c_str(), step_benchmark, std::string(name));
  }
}

/// Number of runs for the latencies. All runs take the same steps, so the shortest time of each step excludes
/// disturbances by the machine.
constexpr benchmark::IterationCount kRuns = 5;

void latency(benchmark::State& state, const std::string& name) {
  if (!proved(state, "step/" + name, [&name] { return wrong_run(name); })) return;
  TimedRun run(name);
  std::vector<std::uint64_t> all, best;
  for (auto _ : state) {
    StepTimes times(run.steps_left());
    run.rewind();
    times.start();
    while (run.simulation().step()) times.lap();
    const auto ns = times.nanoseconds();
    all.insert(all.end(), ns.begin(), ns.end());
    if (best.empty()) best.assign(ns.begin(), ns.end());
    for (std::size_t k = 0; k < ns.size(); ++k) best[k] = std::min(best[k], ns[k]);
  }
  const StepLatency single = step_latency(all, 0), repeatable = step_latency(best, 0);
  state.counters["p50_s"] = 1e-9 * static_cast<double>(single.p50);
  state.counters["p99_9_s"] = 1e-9 * static_cast<double>(repeatable.p99_9);
  state.counters["longest_s"] = 1e-9 * static_cast<double>(repeatable.max);
  state.counters["steps"] = static_cast<double>(repeatable.steps);
  state.counters["late"] = static_cast<double>(repeatable.misses[1]);
}

void add_latencies() {
  for (const char* name : {"T1", "T2", "T2_proxy", "T3", "unreduced_1000", "upright_proxy"}) {
    benchmark::RegisterBenchmark(fmt::format("latency/{}", name).c_str(), latency, std::string(name))
        ->Iterations(kRuns)
        ->Unit(benchmark::kMillisecond);
  }
}

constexpr std::uint64_t kStepsAtATime = 64;

/// Returns n points on the wall of a hole that the upright drill fills. The wall lies 0.05 mm inside the surface of the
/// drill, so all points are contacts. The points are evenly distributed, like the seeds of a sunflower.
std::shared_ptr<const PointShell> wall(std::size_t n, const Cylinder& tool) {
  const double radius = tool.radius() - 5e-5, turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<SurfacePoint> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = turn * static_cast<double>(i);
    const Vec3 out{std::cos(angle), std::sin(angle), 0.0};
    const double height = 0.004 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    points[i] = {radius * out + Vec3{0.0, 0.0, height}, -out};
  }
  return std::make_shared<const PointShell>(points, 0.0);
}

/// Returns a run of the drill at rest in the hole of wall(n), held by its n contacts, without a hand.
std::unique_ptr<WatchedRun> filled_hole(std::size_t n, Skips skips) {
  static const LoadedScenario loaded =
      load_unrecorded("round_the_wall", {"rendering.reduction=null", "hand={\"type\":\"none\"}",
                                         "device={\"type\":\"ideal\"}", "initial.position_m=[0,0,-0.0005]"});
  Scenario scenario = loaded.scenario;
  scenario.rendering.skips = skips;
  SimulationConfig config = simulation_config(scenario);
  config.steps = 1'000'000'000;  // more than the number of timed steps
  auto run = std::make_unique<WatchedRun>(
      config, assemble(scenario, NamedFiles(scenario), wall(n, make_cylinder(scenario.tool)), {}), nullptr);
  run->simulation.advance(kStepsAtATime);
  return run;
}

void step(benchmark::State& state, std::size_t n) {
  const auto wrong = [n]() -> std::string {
    const auto run = filled_hole(n, Skips::on), reference = filled_hole(n, Skips::off);
    if (reported(run->metrics, "colliding_mean") != static_cast<double>(n)) return "not every point is a contact";
    return run->metrics.state_hash() == reference->metrics.state_hash() ? "" : "not the run without skips";
  };
  if (!proved(state, fmt::format("growth/step/{}", n), wrong)) return;
  const auto run = filled_hole(n, Skips::on);
  while (state.KeepRunningBatch(kStepsAtATime)) run->simulation.advance(kStepsAtATime);
  state.counters["contacts"] = reported(run->metrics, "colliding_mean").value_or(0.0);
}

void add_growth() {
  for (const std::size_t n : kGrowthContacts) {
    benchmark::RegisterBenchmark(fmt::format("growth/step/{}", n).c_str(), step, n);
  }
}

/// Times one force algorithm on fixed contacts.
void rendering_benchmark(benchmark::State& state, RenderingConfig config, std::size_t contacts, Skips skips) {
  const std::size_t capacity = std::max<std::size_t>(contacts, 1);
  const auto made = [&](Skips s) {
    config.skips = s;
    auto algorithm = make_algorithm(config);
    algorithm->prepare({.capacity = capacity});
    algorithm->reset();
    return algorithm;
  };
  const auto rendering = made(skips), other = made(skips == Skips::off ? Skips::on : Skips::off);
  ContactBuffer buffer = task_contacts(capacity);
  if (contacts == 0) buffer.clear();
  const ToolState tool{{}, {0.001, -0.002, 0.003}};
  ContactBuffer others = buffer;
  RenderedForce force, expected;
  rendering->compute(tool, buffer, force);
  other->compute(tool, others, expected);
  if (force.rendered != expected.rendered || force.spring != expected.spring) {
    return refute(state, "the skip changes the force");
  }
  for (auto _ : state) {
    rendering->compute(tool, buffer, force);
    benchmark::DoNotOptimize(force);
  }
  state.counters["contacts"] = static_cast<double>(contacts);
}

/// Times a query in free air. With skips, the query compares no point: the neighbour list is empty, and the tool has
/// not left its skin. Without skips (brute force), the query compares every point.
void clearance_benchmark(benchmark::State& state, Skips skips) {
  const TaskScene& scene = task_scene("T1");
  const ToolPose pose{{0.0, 0.0, 0.002}, {0.0, 0.0, -1.0}};
  const auto query = make_contact_query(*scene.shell, *scene.tool, skips);
  const auto other = make_contact_query(*scene.shell, *scene.tool, skips == Skips::on ? Skips::off : Skips::on);
  ContactBuffer contacts(query->capacity());
  for (ContactQuery* each : {query.get(), other.get()}) {
    each->contacts_at(pose, contacts);
    if (!contacts.empty()) return refute(state, "contacts in free air");
  }
  for (auto _ : state) query->contacts_at(pose, contacts);
}

/// Times T3 without observers. With the skip off, ratios and energies are computed although no observer reads them.
void records_benchmark(benchmark::State& state, Skips skips) {
  const Scenario& scenario = step_scenario("T3").scenario;
  const auto run = [&scenario](Skips s) {
    SimulationConfig config = simulation_config(scenario);
    config.skips = s;
    return Simulation(config, assemble(scenario, NamedFiles(scenario), block_shell(), {}), {});
  };
  Simulation simulation = run(skips), other = run(skips == Skips::off ? Skips::on : Skips::off);
  for (int k = 0; k < 2048; ++k) {
    simulation.step();
    other.step();
  }
  if (simulation.tool().pose.position != other.tool().pose.position) return refute(state, "the skip changes the run");
  constexpr benchmark::IterationCount kBatch = 16'384;
  while (state.KeepRunningBatch(kBatch)) {
    state.PauseTiming();
    simulation.reset();
    state.ResumeTiming();
    for (benchmark::IterationCount k = 0; k < kBatch; ++k) simulation.step();
  }
}

/// Returns the rendering of the thesis's drill: shaping, reduction and friction.
RenderingConfig task_rendering() {
  RenderingConfig config;
  config.reduction = ReductionConfig{};
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  return config;
}

void add_skips() {
  RenderingConfig plain = task_rendering();
  plain.reduction.reset();
  plain.mu_s = plain.mu_f = 0.0;
  for (const Skips skips : {Skips::on, Skips::off}) {
    const auto add = [skips](const char* what, auto function, auto... arguments) {
      const char* setting = skips == Skips::on ? "taken" : "off";
      benchmark::RegisterBenchmark(fmt::format("skip/{}/{}", what, setting).c_str(), function, arguments..., skips);
    };
    add("clearance", clearance_benchmark);
    add("no_contact", rendering_benchmark, task_rendering(), std::size_t{0});
    add("reduction_of_one", rendering_benchmark, task_rendering(), std::size_t{1});
    add("no_friction", rendering_benchmark, plain, std::size_t{1});
    add("unwanted_records", records_benchmark);
  }
}

}  // namespace

void register_steps() {
  add_steps();
  add_latencies();
  add_growth();
  add_skips();
}

}  // namespace hapbench::bench
