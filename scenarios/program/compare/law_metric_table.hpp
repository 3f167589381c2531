#pragma once

#include <cstddef>
#include <string>

#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {

/// Returns the words that say over which seeds the means in a scenario are computed, such as "over the 3 of 4 seeds in
/// which no algorithm failed". Returns an empty text if the means are over all seeds.
std::string seeds_of_means_text(const Ranking& ranking, std::size_t scenario);

/// Returns the table of a comparison for a paper: a row for each scenario and law, the laws in the order of their mean
/// ranks. The columns are the number of failed runs if a run failed, each metric with its mean and its spread over the
/// seeds, and the mean rank of the law over all scenarios and metrics.
Table law_metric_table(const Ranking& ranking);

}  // namespace hapbench
