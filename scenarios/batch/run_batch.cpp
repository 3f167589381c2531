#include "scenarios/batch/run_batch.hpp"

#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/shared_shells.hpp"

namespace hapbench {
namespace {

std::vector<std::size_t> uses_of_environments(const BatchPlan& plan) {
  std::vector<std::size_t> uses(plan.environment_count);
  for (const std::size_t environment : plan.environments) uses[environment] += plan.size() / plan.scenarios.size();
  return uses;
}

RunReport run_one(const BatchPlan& plan, const BatchOptions& options, SharedShells& shells, std::size_t number) {
  const LoadedScenario loaded = scenario_of(plan, number);
  RunTiming timing;
  const auto shell = shells.take(plan.environments[plan.run(number).scenario], loaded.scenario, &timing);
  RunReport report = run_with_shell(loaded, shell, options.directory / run_directory(plan, number), false, timing);
  report.targets.clear();  // they are in the file; a batch may have very many
  return report;
}

}  // namespace

BatchReport run_batch(const BatchPlan& plan, const BatchOptions& options) {
  BatchReport report;
  report.runs.resize(plan.size());
  SharedShells shells(uses_of_environments(plan));
  for_each_job(plan.size(), {static_cast<unsigned>(options.jobs), options.progress ? "compare" : ""},
               [&](std::size_t number) { report.runs[number] = run_one(plan, options, shells, number); });
  return report;
}

}  // namespace hapbench
