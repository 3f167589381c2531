#pragma once

#include <filesystem>

#include "results/io/columns.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// The columns of league.csv, a table with a row for each scenario, algorithm and metric.
std::vector<Column> league_columns();

/// Writes league.csv. Throws IoError.
void write_league(const std::filesystem::path& file, const League& league);

/// The same rows as objects, and an object for each algorithm.
Json league_json(const League& league);

}  // namespace hapbench
