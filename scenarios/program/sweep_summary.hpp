#pragma once

#include <string>

#include "scenarios/batch/run_sweep.hpp"

namespace hapbench {

/// The metric `sweep` shows: the one asked for, or else the first of kDefaultMetrics that the runs have. Throws
/// InputError when they have none of that name.
std::string chosen_metric(const SweepPlan& plan, const std::string& asked_for);

/// What `sweep` prints: of one field the runs with their main metrics, if they are not too many, of two the grid of the
/// metric (grid_text), and the counts.
std::string summary_text(const SweepPlan& plan, const SweepReport& report, const std::string& metric);
/// With the rows that the report has.
Json summary_json(const SweepPlan& plan, const SweepReport& report);

}  // namespace hapbench
