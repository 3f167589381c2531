#include <fmt/format.h>

#include "algorithms/registry.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/contact_samples.hpp"
#include "tests/bench/task_scene.hpp"
#include "tests/support/bits.hpp"

/// What each skip saves: the same answer with the skip taken and with it off. The neighbour list and the grid, which
/// are skips too, are search/*.
namespace hapbench::bench {
namespace {

std::uint64_t bits_of(const RenderedForce& force) {
  test::Hash hash;
  hash.add(force.rendered);
  hash.add(force.spring);
  return hash.value();
}

/// One force algorithm on fixed contacts.
class Rendering {
 public:
  Rendering(RenderingConfig config, Skips skips, std::size_t contacts)
      : all_(task_contacts(std::max<std::size_t>(contacts, 1))), contacts_(all_) {
    config.skips = skips;
    algorithm_ = make_algorithm(config);
    algorithm_->prepare({.capacity = all_.capacity()});
    algorithm_->reset();
    if (contacts == 0) contacts_.clear();
  }
  const RenderedForce& compute() {
    algorithm_->compute({{}, {0.001, -0.002, 0.003}}, contacts_, force_);
    return force_;
  }

 private:
  ContactBuffer all_, contacts_;
  std::unique_ptr<ForceAlgorithm> algorithm_;
  RenderedForce force_;
};

void rendering_benchmark(benchmark::State& state, const RenderingConfig& config, std::size_t contacts, Skips skips) {
  Rendering rendering(config, skips, contacts), other(config, skips == Skips::off ? Skips::on : Skips::off, contacts);
  if (bits_of(rendering.compute()) != bits_of(other.compute())) {
    return refute(state, "the skip changes the force");
  }
  for (auto _ : state) benchmark::DoNotOptimize(rendering.compute());
  state.counters["contacts"] = static_cast<double>(contacts);
}

/// A query in free air, where the list's clearance answers and the grid looks into its cells.
void clearance_benchmark(benchmark::State& state, Skips skips) {
  const TaskScene& scene = task_scene("T1");
  const ToolPose pose{{0.0, 0.0, 0.002}, {0.0, 0.0, -1.0}};
  NeighbourListQuery list(*scene.shell, *scene.tool);
  GridQuery grid(*scene.shell, *scene.tool);
  ContactQuery& query = skips == Skips::on ? static_cast<ContactQuery&>(list) : grid;
  ContactBuffer contacts(query.capacity());
  for (ContactQuery* each : {static_cast<ContactQuery*>(&list), static_cast<ContactQuery*>(&grid)}) {
    each->contacts_at(pose, contacts);
    if (!contacts.empty()) return refute(state, "contacts in free air");
  }
  for (auto _ : state) query.contacts_at(pose, contacts);
}

/// T3 watched by an observer that wants nothing; off: ratios and energies are computed all the same.
void records_benchmark(benchmark::State& state, Skips skips) {
  const Scenario& scenario = step_scenario("T3").scenario;
  const auto run = [&scenario](Skips s) {
    SimulationConfig config = simulation_config(scenario);
    config.skips = s;
    return Simulation(config, assemble(scenario, block_shell(), {}), {});
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

/// The drill of the thesis: shaping, reduction and friction.
RenderingConfig task_rendering() {
  RenderingConfig config;
  config.reduction = ReductionConfig{};
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  return config;
}

}  // namespace

void register_skips() {
  RenderingConfig plain = task_rendering();
  plain.reduction.reset();
  plain.mu_s = plain.mu_f = 0.0;
  for (const Skips skips : {Skips::on, Skips::off}) {
    const auto add = [skips](const char* what, auto function, auto... arguments) {
      const char* way = skips == Skips::on ? "taken" : "off";
      benchmark::RegisterBenchmark(fmt::format("skip/{}/{}", what, way).c_str(), function, arguments..., skips);
    };
    add("clearance", clearance_benchmark);
    add("no_contact", rendering_benchmark, task_rendering(), std::size_t{0});
    add("reduction_of_one", rendering_benchmark, task_rendering(), std::size_t{1});
    add("no_friction", rendering_benchmark, plain, std::size_t{1});
    add("unwanted_records", records_benchmark);
  }
}

}  // namespace hapbench::bench
