#pragma once

#include <vector>

#include "scenarios/analysis/work_precision/work_precision.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/report.hpp"

/// Tables and text of `converge --over`: run time against error.
namespace hapbench {

/// Reports a work-precision study: the files convergence.csv and convergence_timing.csv, the JSON, and the text with
/// the cheapest setting below `max_error` [m] of each problem.
void report_work_precision(const std::vector<WorkPrecisionProblem>& problems, double max_error, const Layout& layout,
                           Report& report);

/// Returns the descriptions of both tables.
std::vector<DescribedTable> work_precision_tables();

}  // namespace hapbench
