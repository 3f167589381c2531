#pragma once

#include <cstdint>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/columns.hpp"

/// The tables of `compare`.
namespace hapbench {

/// A line of comparison.csv: a run, and the number of its repetition.
struct ComparedRun {
  std::uint64_t seed;
  const Result& run;
};

/// Without times, so that equal comparisons give equal bytes; several seeds get a column in front.
Columns<ComparedRun> comparison_columns(bool seeds);
/// league.csv, a row for each scenario, algorithm and metric; `seeds`: there are several.
Columns<Standing> league_columns(bool seeds);
/// The table of the algorithms over all scenarios and metrics.
Columns<LawStanding> law_columns();
/// Returns the tables that this command writes and prints, for `describe`.
std::vector<DescribedTable> league_tables();

}  // namespace hapbench
