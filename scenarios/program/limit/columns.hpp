#pragma once

#include <optional>
#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/limit/question.hpp"

/// Columns of the tables that `limit` writes and prints.
namespace hapbench {

/// Name of a column of limit.csv: the number of runs that are unstable within the stable interval, or stable outside of
/// it. In the JSON, the member with this name is the list of these runs.
inline constexpr const char* kNonMonotonic = "non_monotonic_runs";

/// A row of limit_runs.csv: a run and the case that it belongs to.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;

  operator const LimitRow&() const { return limit; }  // NOLINT: a run is also used as its case
};

/// Returns the direction in which a limit is rounded for a text: to the stable side.
inline Rounding stable_side(const LimitQuestion& question) {
  return question.search.smallest ? Rounding::up : Rounding::down;
}
/// Returns the tolerance with which a value of the field is printed. The values of a field of integers are exact: their
/// tolerance is only the distance to the next integer.
inline std::optional<double> printed_tolerance(const LimitQuestion& question, const std::optional<double>& tolerance) {
  return question.search.whole ? std::nullopt : tolerance;
}

/// Returns the columns of limit.csv. They include the published closed-form limits of a wall on an impedance device if
/// a case has these limits. In all functions of this header, `table` is the table that is printed or written, and the
/// columns that do not apply to it are omitted. Null: all columns, for `describe`.
Columns<LimitRow> limit_columns(const LimitTable* table);
/// Returns the columns of limit_runs.csv.
Columns<LimitRunRow> limit_run_columns(const LimitTable* table);
/// Returns the tables that `limit` writes and prints, for `describe`.
std::vector<DescribedTable> limit_tables();

}  // namespace hapbench
