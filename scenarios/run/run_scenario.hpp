#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/run_tables.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Rules of the diagnosis (diagnosis.hpp) that run_scenario() evaluates.
enum class Diagnose {
  nothing,
  low_vibration,  ///< the rules of RuleKind::low_vibration, into Result::low_vibration
  everything      ///< all rules, into Result::diagnosis
};

/// Runs all trials of a scenario, one after the other, and returns the result.
/// - `output`: directory for summary.json, scenario.effective.json and the recorded tables (ResultFolder).
///   Several trials record into one subdirectory each.
/// - `progress`: whether and where to show a progress bar.
/// - `tables`: receives the recorded tables in memory; ignored with `output`. Without `output` and `tables`,
///   the summary has neither provenance nor scenario hash.
/// - `diagnose`: rules of the diagnosis that are evaluated. Unless it is Diagnose::nothing, the run costs about 20 ns
///   more a step.
/// - `shell`: make_shell() of the scenario, if it already exists. Several runs may share it, also at the same
///   time.
/// - `length`: with RunLength::until_failure, the observation of a run ends when the run fails for good or diverges
///   unexpectedly. The run then has RunEnd::ended_at, no metric has a value, and observers and recorded tables get no
///   further step. The outcome is the outcome of the full run. Therefore, if the tool went through the surface, the
///   remaining steps are simulated without observers, because the run may still diverge.
/// Throws InputError before anything is written if the point shell or tool cannot be built from the files.
/// Throws IoError if writing fails, and Stopped if a signal ends the run. No partial results remain after an
/// error.
Result run_scenario(const CheckedScenario& checked, const std::optional<RunOutput>& output, Progress progress,
                    RunTables* tables = nullptr, Diagnose diagnose = Diagnose::nothing,
                    std::shared_ptr<const PointShell> shell = {}, RunLength length = RunLength::full);

/// Runs a scenario with an existing point shell and returns its result. Writes no files and shows no progress.
inline Result run_with_shell(const CheckedScenario& checked, const std::shared_ptr<const PointShell>& shell,
                             Diagnose diagnose = Diagnose::nothing) {
  return run_scenario(checked, {}, false, nullptr, diagnose, shell);
}

}  // namespace hapbench
