#pragma once

#include <vector>

#include "scenarios/analysis/work_precision/work_precision.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/report.hpp"

/// Tables and text of `converge --over`: run time against error.
namespace hapbench {

/// Reports a work-precision study: the files convergence.csv and convergence_timing.csv, the JSON, and the text. For
/// each problem, the text names the cheapest setting whose error is below `max_error` [m].
void report_work_precision(const std::vector<WorkPrecisionProblem>& problems, double max_error, const Layout& layout,
                           Report& report);

/// Reports the error of the rendered force and the time of a step, for each case of a scene with a reference force: the
/// files convergence_model.csv and convergence_model_timing.csv, the JSON, and the text. `cases` vary the law and any
/// other fields. Runs one case after the other, because times are measured. Throws InputError and Stopped.
void report_model_errors(const Cases& cases, const JobOptions& jobs, const Layout& layout, Report& report);

/// Returns the tables of report_work_precision() and report_model_errors(), for `describe`.
std::vector<DescribedTable> work_precision_tables();

}  // namespace hapbench
