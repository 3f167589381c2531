#pragma once

#include <cstdint>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/program/columns.hpp"

/// Columns of the tables that `compare` writes and prints.
namespace hapbench {

/// A row of comparison.csv: a run and the number of its seed, from 0.
struct ComparedRun {
  std::uint64_t seed;
  const Result& run;
};

/// Returns the columns of comparison.csv. No column has a run time, so that equal comparisons give identical files.
/// `seeds`: true if there are several seeds; the first column then has the seed.
Columns<ComparedRun> comparison_columns(bool seeds);
/// Returns the columns of ranking.csv, which has a row for each scenario, algorithm and metric. `seeds`: true if
/// there are several seeds; the printed table then has the spread.
Columns<RankingEntry> ranking_columns(bool seeds);
/// Returns the columns of the table that ranks the algorithms over all scenarios and metrics.
Columns<LawRankingEntry> law_ranking_columns();
/// Returns the tables that `compare` writes and prints, for `describe`.
std::vector<DescribedTable> ranking_tables();

}  // namespace hapbench
