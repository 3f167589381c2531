#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// sweep.csv: its columns and rows.
namespace hapbench {

/// Outcome of a run that an exception ended.
inline constexpr std::string_view kErrorOutcome = "error";

/// A row of sweep.csv.
struct SweepRow {
  std::size_t run = 0;
  std::vector<std::string> values;        ///< of the varied fields
  std::string outcome;                    ///< kErrorOutcome: the row has no steps, metrics and state hash
  bool expected = false;                  ///< the scenario's expectations are met
  std::optional<std::size_t> steps;       ///< steps that were simulated
  std::vector<Metric::Value> metrics;     ///< one for each of the plan's metrics
  std::vector<Metric::Value> tolerances;  ///< of each of the plan's bounded metrics
  std::string state_hash;

  /// The value of a metric of the plan as a number; none when the run has none. Precondition: the plan has the metric.
  std::optional<double> number(const SweepPlan& plan, std::string_view metric) const;
  /// By how much that metric may be wrong; none where that is not known.
  std::optional<double> tolerance(const SweepPlan& plan, std::string_view metric) const;
};

/// The row of a finished run. Throws InputError if the run has a metric for which there is no column.
SweepRow sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary);
/// The row of a run that an exception ended.
SweepRow error_row(const SweepPlan& plan, std::size_t run);

/// Stands before the name of a metric in the heading of its tolerance, as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

/// The line of column names: run number, the varied fields, outcome, expected, steps, every metric, the tolerances,
/// state_hash.
std::string sweep_header(const SweepPlan& plan);
/// The row as a line without its end.
std::string row_text(const SweepRow& row);
/// The row that row_text() wrote; none when the text is not a row of a sweep with these columns.
std::optional<SweepRow> parse_row(const SweepPlan& plan, std::string_view text);
/// The row as an object with the columns' names: numbers and booleans as such, null for empty cells. The values of
/// varied fields are typed by their text, as those of --set are.
Json row_json(const SweepPlan& plan, const SweepRow& row);

/// How the runs of a sweep ended.
struct SweepCounts {
  struct Count {
    std::size_t runs = 0;
    std::size_t expected = 0;
  };
  std::map<std::string, Count> outcomes;
  std::size_t runs = 0;
  std::size_t failed = 0;      ///< runs that an exception ended
  std::size_t unexpected = 0;  ///< runs that ended otherwise than their scenario expects, failed ones not included
  std::optional<std::size_t> first_unexpected;

  void add(const SweepRow& row);
};

/// The JSON file beside a table, which says what the table is about.
Json sweep_description(const SweepPlan& plan, const Shard& shard);

}  // namespace hapbench
