#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/observe/step_times.hpp"
#include "scenarios/cases/league.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Tables with a row for each run, as `run` and `compare` print and write them, and of a league.
namespace hapbench {

/// A printed column of a metric of runs.
struct RunHeading {
  const char *title, *metric;
  double factor = 1.0;  ///< from the metric's unit to the heading's
  bool wide = true;     ///< printed with --wide only
};

/// The figures that separate algorithms: the largest force, the share of rows in contact, the largest force of
/// landings, then of settled contact the mean force, 99 % of the force steps, rms above 30 Hz and reversals per second;
/// then the largest depth below the surface.
inline constexpr RunHeading kRunHeadings[] = {
    {"largest\nforce [N]", "force_max_N", 1.0, false}, {"in contact\n[%]", "contact_share", 100.0},
    {"landing\nforce [N]", "landing_force_max_N"},     {"mean\nforce [N]", "force_mean_in_contact_N", 1.0, false},
    {"force step\n(99 %) [N]", "force_step_p99_N"},    {"vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0, false},
    {"reversals\n[1/s]", "force_reversals_per_s"},     {"deepest\ninside [mm]", "inside_max_m", 1e3, false}};

/// A number with the digits that its tolerance leaves it, three at most; `factor`: to the unit that is shown. "-" for
/// none.
std::string short_text(std::optional<double> value, const std::optional<double>& tolerance, double factor);

/// Adds the columns of headings; `number` and `tolerance` give what a row has of a metric by its name.
template <class Row, class Number, class Tolerance>
void add_metrics(Columns<Row>& columns, std::span<const RunHeading> headings, Number number, Tolerance tolerance) {
  for (const RunHeading& heading : headings) {
    columns.print(
        heading.title, "1", heading.metric,
        [=](const Row& row) {
          return short_text(number(row, heading.metric), tolerance(row, heading.metric), heading.factor);
        },
        heading.wide);
  }
}

/// The printed table of runs, of seven columns: names, how they ended and when, kRunHeadings. Of several algorithms in
/// one scene also the vibration of the tool, which runs without settled contact also have. With --wide also the range
/// of ratios, and what half of the steps take at most. `of_scenes`: of several, told apart by name.
std::string run_table(std::span<const Result> reports, bool of_scenes);

/// Its root is the vibration of the tool.
inline constexpr const char* kToolVibrationPower = "vibration_power_above_30Hz_m2_per_s2";

/// A paragraph on what 99 % of the steps take at most, in the slowest of the runs; empty when no run was long enough to
/// tell. Precondition: there is a report.
std::string step_time_text(std::span<const Result> reports);

/// What is wrong with a run by the rules of its diagnosis, and what to try; of several runs a line each, with the names
/// of the rules. Empty where nothing is.
std::string diagnosis_text(std::span<const Result> reports);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const Result& report);

/// A table of the rendered force against the reference, for the reports that have one; empty without any.
std::string fidelity_text(std::span<const Result> reports);

/// The warnings about runs that were made side by side, but for those that were known before. Warnings of one kind
/// appear once, in the words of the first run and with the names of the algorithms.
std::vector<std::string> run_warnings(std::span<const Result> reports);

/// The latencies [us] and missed deadlines of the steps of a run.
struct LatencyRow {
  std::string scenario;
  StepLatency latency;
};
Columns<LatencyRow> latency_columns();

/// A line of comparison.csv.
struct ComparedRun {
  std::uint64_t seed;  ///< number of its repetition
  const Result* run;
};
/// comparison.csv: algorithm, outcome, steps, and the metrics that separate algorithms, without times, so that equal
/// comparisons give equal bytes; several seeds get a column in front.
Columns<ComparedRun> comparison_columns(bool seeds = false);

std::vector<DescribedTable> run_tables();

/// league.csv, a row for each scenario, algorithm and metric; `seeds`: there are several.
Columns<Standing> league_columns(bool seeds);
/// A table of the standings, if that is short or with --wide, a line for each algorithm, and who is first in a
/// sentence.
std::string league_text(const League& league);
Json league_json(const League& league);

/// A number with the digits that its error leaves it: one where the error is larger, six where it is 0, four where it
/// is not known.
std::string number_text(double value, const std::optional<double>& error);
/// The same with the error behind: "1.234 +- 0.005".
std::string with_error_text(double value, const std::optional<double>& error);

}  // namespace hapbench
