#pragma once

#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/report.hpp"

/// The run times of `compare --time`.
namespace hapbench {

/// Measures the processor time of each law in each scene (measure_cost), writes comparison_timing.csv, prints the table
/// and adds the JSON field "times". `reports`: the results of the comparison's runs.
void report_times(const Comparison& comparison, const std::vector<Result>& reports, const JobOptions& jobs,
                  const Layout& layout, Report& report);

/// Returns the description of comparison_timing.csv.
DescribedTable times_table();

}  // namespace hapbench
