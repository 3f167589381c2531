#pragma once

#include <string>
#include <vector>

#include "scenarios/batch/ranking_check.hpp"

/// `compare --check`: whether the ranking holds when the scenes are sampled twice as finely.
namespace hapbench {

/// The metrics of the printed table of runs, each a number.
std::vector<std::string> compared_metrics();

/// A table with a line for each metric and halved quantity, and the rule of the verdicts.
std::string ranking_text(const RankingCheck& check);

}  // namespace hapbench
