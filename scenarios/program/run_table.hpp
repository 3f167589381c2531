#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenarios/program/table.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// The figures `run` and `compare` show of a run, those that separate algorithms: outcome, share of rows in contact,
/// largest force of the landings, then of settled contact mean force, 99 % of the force steps, rms above 30 Hz and
/// reversals a second, then largest depth, ratio range, and what half of the steps take by themselves at most.
std::vector<Table::Column> run_columns();
/// Between the columns, so that the names of all algorithms fit in 100 columns.
inline constexpr std::size_t kRunGap = 1;
std::vector<std::string> run_cells(const RunReport& report);

/// A line that says what 99 % of the steps take by themselves at most, in the quickest and the slowest of the runs; a
/// column more would make the table too wide. Empty when no run was long enough to sample. Precondition: not empty.
std::string step_time_text(std::span<const RunReport> reports);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const RunReport& report);

/// The warnings of runs that were made side by side. Those that differ in their numbers alone stand once, with the
/// numbers of the first and the names of the other algorithms.
std::vector<std::string> run_warnings(std::span<const RunReport> reports);

}  // namespace hapbench
