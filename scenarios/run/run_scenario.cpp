#include "scenarios/run/run_scenario.hpp"

#include <chrono>

#include "algorithms/registry.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/result_folder.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Says what made the results.
void add_provenance(Result& result) {
  result.provenance = provenance();
  const AlgorithmOrigin& origin = find_algorithm(result.algorithm)->origin;
  result.provenance.plugin = origin.file;
  result.provenance.plugin_hash = origin.hash;
}

void finish_tables(const Simulated& run, RunTables& tables) {
  for (const auto& recorder : run.recorders) recorder->finish();
  if (run.result.has_section("targets"))
    write_target_table(&tables.targets.emplace(kTargetTable.columns), run.result.targets);
}

}  // namespace

Result run_scenario(const LoadedScenario& loaded, const std::optional<fs::path>& output, bool progress,
                    RunTables* tables, bool diagnose) {
  RunTiming timing;
  const auto shell = [&] {
    const WaitNotice notice(loaded.scenario.name + ": building the shell", progress);
    const auto start = std::chrono::steady_clock::now();
    auto made = make_shell(loaded.scenario, loaded.files);
    timing.shell = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return made;
  }();
  return run_with_shell(loaded, shell, output, progress, timing, tables, diagnose);
}

Result run_with_shell(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                      const std::optional<fs::path>& output, bool progress, const RunTiming& timing, RunTables* tables,
                      bool diagnose) {
  const Scenario& scenario = loaded.scenario;
  const std::size_t trials = trials_of(scenario).size();
  std::optional<ResultFolder> folder;
  if (output) folder.emplace(*output);
  if (tables != nullptr) tables->trials.reserve(trials);  // the recorders point into it
  const auto target_of = [&](Trial trial) -> std::optional<RecordTarget> {
    if (folder && records_rows(scenario.record)) return folder->of_trial(trial, trials);
    if (!folder && tables != nullptr) return &tables->trials.emplace_back();
    return std::nullopt;
  };
  Simulated run = simulate(loaded, shell, target_of, progress, timing, diagnose);
  Result& result = run.result;
  result.unmet = unmet_expectations(scenario.expect, result);
  result.expected = result.unmet.empty();
  if (!folder && tables == nullptr) return std::move(result);
  const WrittenScenario written(scenario, loaded.files);
  add_provenance(result);
  result.scenario_hash = written.hash();
  if (folder) {
    folder->write(scenario.record, written, run);
  } else {
    finish_tables(run, *tables);
  }
  return std::move(result);
}

}  // namespace hapbench
