#pragma once

#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {

/// Returns the table of a comparison for a paper: a row for each scenario and law, the laws in the order of their mean
/// ranks. The columns are the number of failed runs if a run failed, each metric with its mean and its spread over the
/// seeds, and the mean rank of the law over all scenarios and metrics.
Table law_metric_table(const Ranking& ranking);

}  // namespace hapbench
