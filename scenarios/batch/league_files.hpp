#pragma once

#include <filesystem>

#include "scenarios/batch/league.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Writes league.csv: a row for each scenario, algorithm and metric: scenario, algorithm, metric, seeds, failed,
/// outcome, mean, spread, rank, ratio_to_best, beyond_spread; empty cells for what there is not (league.hpp says when).
/// Throws IoError.
void write_league(const std::filesystem::path& file, const League& league);

/// The same rows as objects, null for what there is not, and a line for each algorithm.
Json league_json(const League& league);

}  // namespace hapbench
