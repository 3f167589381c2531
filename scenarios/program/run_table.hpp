#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenarios/program/table.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// The figures `run` and `compare` show of a run, those that separate algorithms: outcome, share of rows in contact,
/// largest force of the landings, then of settled contact mean force, 99 % of the force steps, rms above 30 Hz and
/// reversals a second, then largest depth, ratio range, time per step.
std::vector<Table::Column> run_columns();
/// Between the columns, so that the names of all algorithms fit in 100 columns.
inline constexpr std::size_t kRunGap = 1;
std::vector<std::string> run_cells(const RunReport& report);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const RunReport& report);

/// The warnings of runs that were made side by side, each once with the algorithms it is about.
std::vector<std::string> run_warnings(std::span<const RunReport> reports);

/// What to know of those of several runs of one scene whose force steps far more where the reduction keeps other points
/// than elsewhere (results/observe/reduction_jumps.hpp): a line with the numbers of the worst and all their algorithms;
/// empty when there are none.
std::string reduction_text(std::span<const RunReport> reports);

/// What to know of those of several runs of one scene whose spring force passed the limit of explicit friction
/// (results/observe/explicit_friction.hpp), a line with their algorithms; empty when none did.
std::string friction_text(std::span<const RunReport> reports);

}  // namespace hapbench
