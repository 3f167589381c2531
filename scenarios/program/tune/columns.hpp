#pragma once

#include <vector>

#include "scenarios/analysis/tuning/tune.hpp"
#include "scenarios/program/columns.hpp"

/// Columns of the tables that `tune` writes and prints.
namespace hapbench {

/// Returns the bounds of --bound as JSON: {"inside_max_m": {"max": 0.0003}}.
Json bounds_json(const TuneQuestion& question);
/// Returns the columns of tune.csv, which has a row for each law.
Columns<TunedLaw> tuned_columns(const TuneQuestion& question);
/// Returns the columns of tune_trials.csv, which has a row for each setting that was evaluated.
Columns<TuneTrial> trial_columns();
/// Returns the tables that `tune` writes and prints, for `describe`.
std::vector<DescribedTable> tune_tables();

}  // namespace hapbench
