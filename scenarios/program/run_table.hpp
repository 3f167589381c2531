#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/program/report.hpp"

/// Tables with a row for each run, which `run`, `compare` and `sweep` print.
namespace hapbench {

/// A printed column with a metric of runs.
struct RunHeading {
  const char *title, *metric;
  double factor = 1.0;  ///< conversion factor from the metric's unit to the unit in the heading
  bool wide = true;     ///< true if the column is printed only with --wide
};

/// Columns for the metrics in which force algorithms differ most visibly.
inline constexpr RunHeading kRunHeadings[] = {
    {"largest\nforce [N]", "force_max_N", 1.0, false}, {"in contact\n[%]", "contact_share", 100.0},
    {"landing\nforce [N]", "landing_force_max_N"},     {"mean\nforce [N]", "force_mean_in_contact_N", 1.0, false},
    {"force step\n(99 %) [N]", "force_step_p99_N"},    {"vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0, false},
    {"reversals\n[1/s]", "force_reversals_per_s"},     {"max depth\ninside [mm]", "inside_max_m", 1e3, false}};

/// Returns the unit of a metric; "1" for an unknown metric.
std::string metric_unit(const std::string& metric);

/// Returns `factor` times the value as text. `tolerance` is the error of the value, in the unit of `value`. The text
/// has at most three digits, and only digits that the tolerance leaves certain. If the value is not larger than its
/// tolerance, returns bound_text(), such as "<= 0.4". If there is no value, returns "-".
std::string short_text(std::optional<double> value, const std::optional<double>& tolerance, double factor);

/// Adds a column for each heading. figure_of(row, metric name) returns the row's value of the metric as
/// NumberWithError.
template <class Row, class Figure>
void add_metrics(Columns<Row>& columns, std::span<const RunHeading> headings, Figure figure_of) {
  for (const RunHeading& heading : headings) {
    const auto text = [=](const Row& row) {
      const auto [value, error] = figure_of(row, heading.metric);
      return short_text(value, error, heading.factor);
    };
    columns.add({{heading.title, "1", heading.metric, text, only_printed(heading.wide)}});
  }
}

/// Returns the printed table of runs: names, outcome with its time, and the columns of kRunHeadings whose member `wide`
/// is false. With --wide, the table also has the other columns of kRunHeadings, the vibration of the tool, the range of
/// stiffness ratios, and the median time of a step. If `of_scenes` is true, the first column has the names of the
/// scenarios. If `of_scenes` is false, all runs belong to one scenario, and the table has the vibration of the tool
/// even without --wide. This vibration is defined also for runs without settled contact.
Table run_table(std::span<const Result> reports, bool of_scenes, const Layout& layout);

/// Returns the text that explains the columns of kRunHeadings that are printed without --wide.
/// `has_empty_mean`: true if the table has a run without a mean force. `has_depth`: true if the table has a depth.
std::string headings_legend(bool has_empty_mean, bool has_depth, const Layout& layout);
/// Returns headings_legend() for run_table(), after an empty line.
std::string run_legend(std::span<const Result> reports, const Layout& layout);

/// Metric whose square root is the vibration of the tool.
inline constexpr const char* kToolVibrationPower = "vibration_power_above_30Hz_m2_per_s2";

/// Returns a sentence with the 99th percentile of the computing time of a step, in the run with the largest such
/// percentile. Returns an empty text if all runs are too short for a 99th percentile. With --latency, a separate table
/// has the percentiles, and the sentence is returned only if this percentile is longer than the scenario's time step.
/// Precondition: there is at least one run.
std::string step_time_text(std::span<const Result> reports, const Layout& layout);

/// Reports a table that compares the rendered force with the reference force, for the runs with a reference force.
/// Reports nothing if no run has a reference force.
void report_fidelity(std::span<const Result> reports, const Layout& layout, Report& report);

/// Returns the warnings about the runs of one scenario, without the warnings that were printed before the runs. Equal
/// texts of several algorithms are merged into one line with the names of the algorithms. If the warnings about several
/// runs of one algorithm differ only in their numbers, one line quotes the first warning and counts the others.
std::vector<std::string> run_warnings(std::span<const Result> reports);

/// Returns a text with the value of a diagnosis rule, its threshold and their unit, such as "0.289, threshold 0.1".
std::string value_and_threshold_text(const Diagnosed& found);

/// Returns a number for a text that also states the number's error. The text has only the digits that the error leaves
/// certain, and one digit if the error is not smaller than the number. It has six digits if the error is 0, and four
/// digits if the error is unknown.
std::string number_text(double value, const std::optional<double>& error);
/// Returns number_text() followed by the error: "1.234 +- 0.005".
std::string with_error_text(double value, const std::optional<double>& error);

/// Returns the tables of runs, for `describe`.
std::vector<DescribedTable> run_tables();

}  // namespace hapbench
