#pragma once

#include <cstddef>
#include <string>

#include "scenarios/analysis/convergence/finer_runs.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"

/// How sure the numbers of `compare` are, and which order of laws is larger than that.
namespace hapbench {

/// Reports a table of the numbers of a scenario with their errors, and a sentence on each metric that it shows; `all`:
/// also of metrics that the table of runs shows with --wide only, or not.
void report_errors(const League& league, const FinerRuns& finer, std::size_t scenario, bool all, Report& report,
                   const Layout& layout);
/// Which laws vibrate less by more than hands feel; where one has no settled contact, by the vibration of the tool.
std::string vibration_text(const League& league, const Layout& layout);

}  // namespace hapbench
