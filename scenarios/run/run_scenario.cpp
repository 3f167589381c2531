#include "scenarios/run/run_scenario.hpp"

#include <chrono>
#include <memory>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "results/io/stale_temporaries.hpp"
#include "results/record/contact_recorder.hpp"
#include "results/record/ratio_recorder.hpp"
#include "results/record/trajectory_recorder.hpp"
#include "scenarios/run/allocations.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/environment_points.hpp"
#include "scenarios/run/expectation.hpp"
#include "scenarios/run/progress.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<SurfacePoint> timed_environment_points(const Scenario& scenario, const ShellCache& cache,
                                                   RunTiming& timing) {
  const auto start = Clock::now();
  EnvironmentPoints shell = environment_points(scenario, cache);
  timing.shell = seconds_since(start);
  timing.shell_from_cache = shell.from_cache;
  return std::move(shell.points);
}

Mat3 start_shaping(ContactBuffer& contacts) noexcept {
  return shape_weights(contacts, 0);
}

/// Recorders for what the scenario asks for. Throws IoError.
std::vector<std::unique_ptr<Recorder>> make_recorders(const RecordFields& record, const fs::path& directory,
                                                      std::size_t contact_capacity) {
  const auto every = static_cast<std::uint64_t>(record.every);
  std::vector<std::unique_ptr<Recorder>> recorders;
  if (record.trajectory) recorders.push_back(std::make_unique<TrajectoryRecorder>(directory / "trajectory.csv", every));
  if (record.contacts) recorders.push_back(std::make_unique<ContactRecorder>(directory / "contacts.csv", every));
  if (!record.ratio_iterations.empty()) {
    const std::vector<int> iterations(record.ratio_iterations.begin(), record.ratio_iterations.end());
    const ShapingOperations shaping{start_shaping, update_shaped_weights};
    recorders.push_back(
        std::make_unique<RatioRecorder>(directory / "ratios.csv", every, iterations, shaping, contact_capacity));
  }
  return recorders;
}

/// Optional files that an earlier run with other settings may have left: they would not belong to this run.
void remove_files_of_earlier_runs(const fs::path& directory) {
  for (const char* name : {"summary.json", "trajectory.csv", "contacts.csv", "ratios.csv", "timing.json"}) {
    std::error_code ignored;
    fs::remove(directory / name, ignored);
  }
}

void create_output(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) throw IoError("create", directory, error);
  remove_stale_temporaries(directory);
}

RunSummary summarise(const Scenario& scenario, const Simulation& simulation, const MetricsObserver& metrics,
                     std::uint64_t allocations) {
  RunSummary summary;
  summary.name = scenario.name;
  summary.algorithm = scenario.rendering.config.algorithm;
  summary.result = simulation.result();
  summary.duration = static_cast<double>(summary.result.rows) * scenario.time.step;
  summary.metrics = metrics.metrics();
  summary.work.search = simulation.query().work();
  summary.work.steps_skipped = summary.work.search.skipped;
  summary.work.algorithm = simulation.algorithm().work();
  summary.work.allocations = allocations;
  summary.provenance = provenance();
  summary.scenario_hash = scenario_hash(scenario);
  return summary;
}

void write_results(const fs::path& directory, const Scenario& scenario, const RunReport& report,
                   std::vector<std::unique_ptr<Recorder>>& recorders) {
  remove_files_of_earlier_runs(directory);
  for (const auto& recorder : recorders) recorder->finish();
  write_file_atomically(directory / "scenario.effective.json", json_text(effective_scenario(scenario, directory)));
  if (scenario.record.timing) {
    write_file_atomically(directory / "timing.json", timing_text(report.timing, instruction_set(), provenance()));
  }
  write_file_atomically(directory / "summary.json", summary_text(report.summary));
}

}  // namespace

RunReport run_scenario(const LoadedScenario& loaded, const std::optional<fs::path>& output, bool progress,
                       const ShellCache& cache) {
  const Scenario& scenario = loaded.scenario;
  RunReport report;
  SimulationParts parts = assemble(scenario, timed_environment_points(scenario, cache, report.timing));
  if (output) create_output(*output);

  std::vector<std::unique_ptr<Recorder>> recorders;
  if (output) recorders = make_recorders(scenario.record, *output, parts.query->capacity());
  MetricsObserver metrics(scenario.time.step);
  Progress bar(scenario.name, static_cast<std::uint64_t>(*scenario.time.steps), progress);
  std::vector<Observer*> observers = {&metrics, &bar};
  for (const auto& recorder : recorders) observers.push_back(recorder.get());
  Simulation simulation(simulation_config(scenario), std::move(parts), observers);

  const std::uint64_t allocations_before = heap_allocations();
  const auto start = Clock::now();
  report.timing.steps = simulation.run().rows;
  report.timing.loop = seconds_since(start);
  const std::uint64_t allocations = heap_allocations() - allocations_before;

  report.summary = summarise(scenario, simulation, metrics, allocations);
  report.unmet = unmet_expectations(scenario.expect, report.summary);
  report.summary.expected = report.unmet.empty();
  if (output) write_results(*output, scenario, report, recorders);
  return report;
}

}  // namespace hapbench
