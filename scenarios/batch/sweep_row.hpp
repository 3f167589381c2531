#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "results/summary/summary.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// The rows of sweep.csv, as lines without their ends. No cell needs quotes.
namespace hapbench {

/// Column names: run number, the varied fields, outcome, expected, steps, every metric, state_hash.
std::string sweep_header(const SweepPlan& plan);

/// The row of a finished run; empty cells for what it has not. Throws InputError for a run that has what no column
/// holds.
std::string sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary);

/// Outcome of a run that an exception ended; its row has no numbers.
inline constexpr std::string_view kErrorOutcome = "error";
std::string error_row(const SweepPlan& plan, std::size_t run);

/// The number of a row's run; none when the row is not of this sweep.
std::optional<std::size_t> run_of_row(const SweepPlan& plan, std::string_view row);

}  // namespace hapbench
