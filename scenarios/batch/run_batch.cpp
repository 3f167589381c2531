#include "scenarios/batch/run_batch.hpp"

#include <chrono>

#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

RunReport run_one(const BatchPlan& plan, const BatchOptions& options, std::size_t number) {
  const LoadedScenario loaded = scenario_of(plan, number);
  RunTiming timing;
  const auto start = std::chrono::steady_clock::now();
  const auto shell = make_shell(loaded.scenario, loaded.files);
  timing.shell = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RunReport report = run_with_shell(loaded, shell, options.directory / run_directory(plan, number), false, timing);
  report.targets.clear();  // they are in the file; a batch may have very many
  return report;
}

}  // namespace

BatchReport run_batch(const BatchPlan& plan, const BatchOptions& options) {
  BatchReport report;
  report.runs.resize(plan.size());
  for_each_job(plan.size(), {static_cast<unsigned>(options.jobs), options.progress ? "compare" : ""},
               [&](std::size_t number) { report.runs[number] = run_one(plan, options, number); });
  return report;
}

}  // namespace hapbench
