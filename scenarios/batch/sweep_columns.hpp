#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// Columns of sweep.csv: their names and the cells of a row. A new column needs one line in each function.
namespace hapbench {

/// Beginning of the heading of a tolerance column; the name of the metric follows. The same as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

/// Heading and meaning of the column of RunEnd::ended_at.
inline constexpr std::string_view kEndedAt = "ended_at_s";
inline constexpr const char* kEndedAtMeaning =
    "time at which the run failed and ended early; its metrics are then empty (hapbench describe \"early end\"); empty "
    "for all other runs";

/// Returns the names of the columns: index, varied fields, outcome, expected, steps, ended_at_s, metrics, tolerances,
/// state_hash.
std::vector<std::string> sweep_columns(const SweepPlan& plan);

/// Returns the row of a run that ended with an exception, without a newline. The cells after "expected" are
/// empty.
std::string error_row(const SweepPlan& plan, std::size_t run);

/// Returns the row of a run, without a newline. Throws InputError if the run has a metric for which there is no column.
std::string finished_row(const SweepPlan& plan, std::size_t run, const Result& summary);

}  // namespace hapbench
