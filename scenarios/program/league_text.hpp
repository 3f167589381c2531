#pragma once

#include <string>

#include "scenarios/batch/league.hpp"

namespace hapbench {

/// A league for the terminal: for each metric a table of algorithms and scenarios, as much of rank, ratio to the best,
/// mean and spread as fits into kTableWidth, then a line for each algorithm, then what the signs mean and by which rule
/// a difference is more than the spread.
std::string league_text(const League& league);

}  // namespace hapbench
