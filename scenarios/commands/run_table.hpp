#pragma once

#include <string>
#include <vector>

#include "scenarios/commands/table.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

/// The figures `run` and `compare` show of a run: outcome, largest force, total variation of velocity, force direction
/// reversals, vibration power above 30 Hz, largest depth, ratio range, time per step.
std::vector<Table::Column> run_columns();
std::vector<std::string> run_cells(const RunReport& report);

}  // namespace hapbench
