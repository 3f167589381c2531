#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/layout.hpp"

/// Tables with a row for each run, as `run` and `compare` print and write them.
namespace hapbench {

/// A printed column of a metric of runs.
struct RunHeading {
  const char *title, *metric;
  double factor = 1.0;  ///< from the metric's unit to the heading's
  bool wide = true;     ///< printed with --wide only
};

/// The figures that separate algorithms.
inline constexpr RunHeading kRunHeadings[] = {
    {"largest\nforce [N]", "force_max_N", 1.0, false}, {"in contact\n[%]", "contact_share", 100.0},
    {"landing\nforce [N]", "landing_force_max_N"},     {"mean\nforce [N]", "force_mean_in_contact_N", 1.0, false},
    {"force step\n(99 %) [N]", "force_step_p99_N"},    {"vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0, false},
    {"reversals\n[1/s]", "force_reversals_per_s"},     {"max depth\ninside [mm]", "inside_max_m", 1e3, false}};

/// A number, "-" for none, with the digits that its tolerance leaves it, three at most; `factor`: to the shown unit.
std::string short_text(std::optional<double> value, const std::optional<double>& tolerance, double factor);

/// Adds the columns of headings; `figure_of` gives what a row has of a metric by its name, a NumberWithError.
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

/// The printed table of runs, of seven columns: names, how they ended and when, kRunHeadings. Of several algorithms in
/// one scene also the vibration of the tool, which runs without settled contact also have. With --wide also the range
/// of ratios, and what half of the steps take at most. `of_scenes`: of several, told apart by name.
std::string run_table(std::span<const Result> reports, bool of_scenes, const Layout& layout);

/// Its root is the vibration of the tool.
inline constexpr const char* kToolVibrationPower = "vibration_power_above_30Hz_m2_per_s2";

/// What 99 % of the steps take at most, in the slowest run, of which there is one; empty where all are too short.
std::string step_time_text(std::span<const Result> reports, const Layout& layout);

/// A table of the rendered force against the reference, for the reports that have one.
std::string fidelity_text(std::span<const Result> reports, const Layout& layout);

/// The warnings about runs side by side, but for those that were known before: those of one kind once, in the words of
/// the first run and with the names of the algorithms.
std::vector<std::string> run_warnings(std::span<const Result> reports);

/// A number with the digits that its error leaves: one where the error is larger, six where it is 0, four if unknown.
std::string number_text(double value, const std::optional<double>& error);
/// The same with the error behind: "1.234 +- 0.005".
std::string with_error_text(double value, const std::optional<double>& error);

/// Returns the tables that this command writes and prints, for `describe`.
std::vector<DescribedTable> run_tables();

}  // namespace hapbench
