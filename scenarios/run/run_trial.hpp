#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "results/record/recorder.hpp"
#include "results/summary.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {

/// What one trial of a scenario came to; most scenarios have one.
struct TrialResult {
  SimulationResult result;
  Metrics metrics;
  std::optional<EnergyMetrics> energy;
  std::optional<IdealTrajectoryMetrics> ideal_trajectory;
  std::vector<TargetRow> targets;  ///< of a tracking hand
  RunWork work;
  double loop_seconds = 0.0;  ///< wall time of the step loop
  /// Files of what was recorded, complete but under temporary names until `finish`.
  std::vector<std::unique_ptr<Recorder>> recorders;
};

/// Runs one trial. `shell` is make_shell of the scenario. With `directory`, which exists, records there what the
/// scenario asks for. A progress bar is drawn with `label`, unless that is empty. Throws InputError for files it cannot
/// use and IoError when a record cannot be written.
TrialResult run_trial(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial,
                      const std::optional<std::filesystem::path>& directory, const std::string& label);

}  // namespace hapbench
