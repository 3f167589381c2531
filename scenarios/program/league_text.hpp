#pragma once

#include <string>
#include <vector>

#include "scenarios/batch/league.hpp"
#include "scenarios/program/report.hpp"

/// The tables of a league.
namespace hapbench {

/// league.csv, a row for each scenario, algorithm and metric.
Columns<Standing> league_columns();

/// For each metric a table of algorithms and scenarios, with rank, mean and spread as far as they fit into the output,
/// then a line for each algorithm.
std::string league_text(const League& league);

/// Their rows, null for missing values.
Json league_json(const League& league);

}  // namespace hapbench
