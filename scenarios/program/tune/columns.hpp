#pragma once

#include <vector>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/program/columns.hpp"

/// The tables of `tune`.
namespace hapbench {

/// The columns of tune.csv, a row for each law.
Columns<TunedLaw> tuned_columns();
/// The columns of tune_trials.csv.
Columns<TuneTrial> trial_columns();
/// Returns the tables that this command writes and prints, for `describe`.
std::vector<DescribedTable> tune_tables();

}  // namespace hapbench
