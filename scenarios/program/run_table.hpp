#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "scenarios/program/table.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// A heading of the tables of runs.
struct RunHeading {
  const char* title;
  std::array<const char*, 2> shows;  ///< names that `describe` explains; null for none
  bool number = true;
};
inline constexpr RunHeading kRunHeadings[] = {
    {"outcome", {"outcome", nullptr}, false},     {"con\n%", {"contact_share"}},
    {"land.\nmax N", {"landing_force_max_N"}},    {"mean\nN", {"force_mean_in_contact_N"}},
    {"step\np99 N", {"force_step_p99_N"}},        {">30Hz\nrms N", {"force_rms_above_30Hz_N"}},
    {"rev.\n1/s", {"force_reversals_per_s"}},     {"depth\nmm", {"depth_max_m"}},
    {"ratio", {"ratio_min", "ratio_max"}, false}, {"us/\nstep", {"step_p50_s"}}};

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

/// Why runs that touched have "-" for the metrics of settled contact; empty when none has.
std::string unsettled_text(std::span<const RunReport> reports);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const RunReport& report);

/// The warnings of runs that were made side by side. Those that differ in their numbers alone stand once, with the
/// numbers of the first and the names of the other algorithms.
std::vector<std::string> run_warnings(std::span<const RunReport> reports);

}  // namespace hapbench
