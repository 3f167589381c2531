#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "results/summary.hpp"
#include "scenarios/config/load_scenario.hpp"

namespace hapbench {

/// One finished run; of a tracking hand, all its trials.
struct RunReport {
  RunSummary summary;
  std::vector<std::string> unmet;  ///< expectations the run did not meet
  std::vector<TargetRow> targets;  ///< of a tracking hand, all subjects and trials
  double loop_seconds = 0.0;       ///< wall time of the step loops
};

/// Runs a scenario. With `output`, writes summary.json, scenario.effective.json and what the scenario records into that
/// directory, which is created, records of several trials into a subdirectory each; each file appears complete or not
/// at all, the summary last. `progress` allows a progress bar. Throws InputError for files it cannot use (before
/// anything is written), IoError when writing fails.
RunReport run_scenario(const LoadedScenario& loaded, const std::optional<std::filesystem::path>& output, bool progress);

}  // namespace hapbench
