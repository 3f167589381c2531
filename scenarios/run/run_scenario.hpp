#pragma once

#include <algorithm>

#include "scenarios/run/result_folder.hpp"

namespace hapbench {

/// Runs a scenario, all its trials one after the other. With `output`, writes summary.json, scenario.effective.json and
/// what the scenario records into that directory, which is created, records of several trials into a subdirectory each;
/// each file appears complete or not at all, the summary last. With `tables`, and without a directory, what the
/// scenario records goes there. Without either, the summary has no provenance and no scenario hash. `progress` allows a
/// progress bar. With skips off (RenderingConfig), the results are the same but for the counted work. `diagnose`: the
/// result says what is wrong with the run (diagnosis.hpp), for some 20 ns a row. Throws InputError for files it cannot
/// use (before anything is written), IoError when writing fails, Stopped when a signal ends the run: then nothing of it
/// is left.
Result run_scenario(const LoadedScenario& loaded, const std::optional<std::filesystem::path>& output, bool progress,
                    RunTables* tables = nullptr, bool diagnose = false);

/// The same, for its result alone, in a shell that is there already and that several runs, also at once, may share:
/// make_shell of the scenario.
Result run_with_shell(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell);

/// The expectations of the scenario that the run does not meet, one sentence each.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// True when `outcome` is among those the scenario expects.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
