#pragma once

#include <string>

#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/input/json_file.hpp"

/// The parts of `hapbench sweep` that other sources use: what it prints of a table, and what it resumes.
namespace hapbench {

/// The metric that `sweep` shows: the one asked for, or else the first of kDefaultMetrics that there is. Throws
/// InputError when there is none of that name.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for);

/// The counts of outcomes, and above them for a sweep of one field the runs (up to 100) with their main metrics, for a
/// grid of two fields (up to 400 cells) the metric as a table, else the 20 runs with the least of the metric.
std::string summary_text(const SweepTable& table, const std::string& metric);
/// The counts, and the rows that the table has.
Json summary_json(const SweepTable& table);

/// Refuses to begin anew, without --resume, where the finished runs of the same sweep would be lost, and tells when
/// those of another are.
void check_table_under_way(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
