#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "results/record/recorder.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {

/// What the trials of a run gave.
struct Simulated {
  Result result;  ///< without provenance, and without a look at expectations and named files
  /// Their files are complete but under temporary names until `finish`.
  std::vector<std::unique_ptr<Recorder>> recorders;
};

/// The trials of a scenario, subject by subject; most scenarios have one.
std::vector<Trial> trials_of(const Scenario& scenario);

/// Where a trial records; nothing if it does not.
using TargetOfTrial = std::function<std::optional<RecordTarget>(Trial trial)>;

/// Runs all trials of a scenario in its shell, one after the other. `progress` allows a progress bar; `timing` says
/// what is known of the shell's making; `diagnose`: the result has a diagnosis. Throws InputError for files it cannot
/// use, IoError, and Stopped when a signal ends the run.
Simulated simulate(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                   const TargetOfTrial& target_of, bool progress, const RunTiming& timing, bool diagnose);

}  // namespace hapbench
