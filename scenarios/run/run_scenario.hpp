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
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_tables.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Runs a scenario, all its trials one after the other. With `output`, writes summary.json, scenario.effective.json and
/// what the scenario records into that directory (ResultFolder), records of several trials into a subdirectory each.
/// With `tables`, and without a directory, what the scenario records goes there. Without either, the summary has no
/// provenance and no scenario hash. `progress` allows a bar. `diagnose`: the result says what is wrong with
/// the run (diagnosis.hpp), for some 20 ns a row. Throws InputError for points and tools that cannot be made of the
/// files (before anything is written), IoError when writing fails, Stopped when a signal ends the run: then nothing of
/// it is left. `shell`, if it is there already: make_shell of the scenario, which several runs, also at once, may
/// share.
Result run_scenario(const CheckedScenario& checked, const std::optional<std::filesystem::path>& output,
                    Progress progress, RunTables* tables = nullptr, bool diagnose = false,
                    std::shared_ptr<const PointShell> shell = {});

/// The same for its result alone.
inline Result run_with_shell(const CheckedScenario& checked, const std::shared_ptr<const PointShell>& shell) {
  return run_scenario(checked, {}, false, nullptr, false, shell);
}

}  // namespace hapbench
