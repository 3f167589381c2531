#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/observe/step_times.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Tables with a row for each run, as `run` and `compare` print and write them.
namespace hapbench {

/// A printed column of a metric of runs.
struct RunHeading {
  const char *title, *metric;
  double factor;  ///< from the metric's unit to the heading's
};

/// The figures that separate algorithms: the share of rows in contact, the largest force of landings, then of settled
/// contact the mean force, 99 % of the force steps, rms above 30 Hz and reversals per second; then the largest depth
/// below the surface.
inline constexpr RunHeading kRunHeadings[] = {{"con\n%", "contact_share", 100.0},
                                              {"land.\nmax N", "landing_force_max_N", 1.0},
                                              {"mean\nN", "force_mean_in_contact_N", 1.0},
                                              {"step\np99 N", "force_step_p99_N", 1.0},
                                              {">30Hz\nrms N", "force_rms_above_30Hz_N", 1.0},
                                              {"rev.\n1/s", "force_reversals_per_s", 1.0},
                                              {"depth\nmm", "inside_max_m", 1e3}};

/// The printed table of runs: outcome, kRunHeadings, the range of ratios, and what half of the steps take at most.
/// `of_scenes`: of several, told apart by name. Metrics have the digits that their tolerance leaves them. Its width
/// does not depend on the times in it.
std::string run_table(std::span<const Result> reports, bool of_scenes);

/// A paragraph on what 99 % of the steps take at most, in the quickest and the slowest of the runs; empty when no run
/// was long enough to tell. Precondition: there is a report.
std::string step_time_text(std::span<const Result> reports);

/// Explains "-" for metrics of settled contact in runs that touched; empty when there is none.
std::string unsettled_text(std::span<const Result> reports);

/// What is wrong with a run by the rules of its diagnosis, and what to try; of several runs a line each, with the names
/// of the rules. Empty where nothing is.
std::string diagnosis_text(std::span<const Result> reports);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const Result& report);

/// A table of the rendered force against the reference, for the reports that have one; empty without any.
std::string fidelity_text(std::span<const Result> reports);

/// The warnings about runs that were made side by side, but for those that were known before. Warnings of one kind
/// appear once, in the words of the first run and with the names of the other algorithms.
std::vector<std::string> run_warnings(std::span<const Result> reports);

/// The latencies [us] and missed deadlines of the steps of a run.
struct LatencyRow {
  std::string scenario;
  StepLatency latency;
};
Columns<LatencyRow> latency_columns();

/// A line of comparison.csv.
struct ComparedRun {
  std::uint64_t seed = 0;  ///< number of its repetition
  std::string algorithm, outcome;
  std::uint64_t steps = 0;
  std::vector<Cell> metrics;
};
/// The runs of one scene, the seeds of an algorithm one after the other.
std::vector<ComparedRun> compared_runs(std::span<const Result> reports, std::size_t seeds);
/// comparison.csv: algorithm, outcome, steps, and the metrics that separate algorithms, without times, so that equal
/// comparisons give equal bytes; several seeds get a column in front.
Columns<ComparedRun> comparison_columns(bool seeds = false);

std::vector<DescribedTable> run_tables();

/// A number with the digits that its error leaves it: one where the error is larger, six where it is 0, four where it
/// is not known.
std::string number_text(double value, const std::optional<double>& error);
/// The same with the error behind: "1.234 +- 0.005".
std::string with_error_text(double value, const std::optional<double>& error);

}  // namespace hapbench
