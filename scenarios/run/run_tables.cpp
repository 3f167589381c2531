#include "scenarios/run/run_tables.hpp"

#include "results/observe/target_metrics.hpp"

namespace hapbench {

void RunTables::write(const Json& of_scenario, const Result& result, const Recorders& recorders) {
  effective = of_scenario;
  for (const auto& recorder : recorders) recorder->finish();
  if (result.sections.contains("targets")) write_target_table(&targets.emplace(kTargetTable.columns), result.targets);
}

}  // namespace hapbench
