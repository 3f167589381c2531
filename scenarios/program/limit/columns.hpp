#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/limit/question.hpp"

/// The tables of `limit`.
namespace hapbench {

/// Columns of the runs that are on neither side of the limit as their neighbours are; the second is the former name.
inline constexpr const char *kInconsistent = "inconsistent_runs", *kAstray = "astray";

/// A line of limit_runs.csv.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;

  operator const LimitRow&() const { return limit; }  // NOLINT: what it has of the case
};

/// The columns of limit.csv; before the last what the literature says of a wall on an impedance device. `table`, here
/// and below: none for all columns that there may be, for `describe`.
Columns<LimitRow> limit_columns(const LimitTable* table);
/// The columns of limit_runs.csv.
Columns<LimitRunRow> limit_run_columns(const LimitTable* table);
/// Returns the tables that this command writes and prints, for `describe`.
std::vector<DescribedTable> limit_tables();

}  // namespace hapbench
