#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/limit/question.hpp"

/// The tables of `limit`.
namespace hapbench {

/// New and old name of one column. The column lists the runs that are unstable within the stable interval, or stable
/// outside of it.
inline constexpr const char* kNonMonotonic = "non_monotonic_runs";

/// A row of limit_runs.csv: a run and the case that it belongs to.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;

  operator const LimitRow&() const { return limit; }  // NOLINT: a run is also used as its case
};

/// Returns the columns of limit.csv. They include the published closed-form limits of a wall on an impedance
/// device if a case has them. In all functions of this header, `table` selects the columns that apply to it; null:
/// all columns, for `describe`.
Columns<LimitRow> limit_columns(const LimitTable* table);
/// Returns the columns of limit_runs.csv.
Columns<LimitRunRow> limit_run_columns(const LimitTable* table);
/// Returns the tables that this command writes and prints, for `describe`.
std::vector<DescribedTable> limit_tables();

}  // namespace hapbench
