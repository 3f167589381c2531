#pragma once

#include <string>

#include "scenarios/cases/league.hpp"
#include "scenarios/program/report.hpp"

/// What is written and printed of a league.
namespace hapbench {

/// league.csv, a row for each scenario, algorithm and metric; `seeds`: there are several.
Columns<Standing> league_columns(bool seeds);
/// A table of the standings, if that is short or with --wide, a line for each algorithm, and who is first in a
/// sentence.
std::string league_text(const League& league);
Json league_json(const League& league);

}  // namespace hapbench
