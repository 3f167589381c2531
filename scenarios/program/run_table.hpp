#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "results/observe/step_times.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Tables with a row for each run, as `run` and `compare` print and write them.
namespace hapbench {

/// A heading of the printed tables of runs.
struct RunHeading {
  const char* title;
  std::array<const char*, 2>
      shows;            ///< the metrics or words below it, which `describe` explains; the second may be null
  double factor = 0.0;  ///< from the metric's unit to the heading's; 0: not a metric's number
  bool number = true;   ///< aligned as one
};

/// The figures that separate algorithms: the outcome, the share of rows in contact, the largest force of landings, then
/// of settled contact the mean force, 99 % of the force steps, rms above 30 Hz and reversals per second; then the
/// largest depth below the surface, the range of ratios, and what half of the steps take at most.
inline constexpr RunHeading kRunHeadings[] = {{"outcome", {"outcome"}, 0.0, false},
                                              {"con\n%", {"contact_share"}, 100.0},
                                              {"land.\nmax N", {"landing_force_max_N"}, 1.0},
                                              {"mean\nN", {"force_mean_in_contact_N"}, 1.0},
                                              {"step\np99 N", {"force_step_p99_N"}, 1.0},
                                              {">30Hz\nrms N", {"force_rms_above_30Hz_N"}, 1.0},
                                              {"rev.\n1/s", {"force_reversals_per_s"}, 1.0},
                                              {"depth\nmm", {"inside_max_m"}, 1e3},
                                              {"ratio", {"ratio_min", "ratio_max"}, 0.0, false},
                                              {"us/\nstep", {"step_p50_s"}}};

/// Those of runs with a reference force: measured with the stroke, or ideal.
inline constexpr RunHeading kFidelityHeadings[] = {
    {"error\n%", {"fidelity.force_error_relative"}, 100.0},
    {"normal\nrms N", {"fidelity.force_error_normal_rms_N"}, 1.0},
    {"tangential\nrms N", {"fidelity.force_error_tangential_rms_N"}, 1.0},
    {"direction\ndeg", {"fidelity.force_direction_error_rad"}, 57.295779513082323},
    {"artefacts\n%", {"fidelity.force_artefact_share"}, 100.0},
    {"lag\nms", {"fidelity.force_lag_s"}, 1e3}};

/// A printed table of runs under kRunHeadings. Its width does not depend on the times in it.
class RunTable {
 public:
  /// `names`: titles of the columns before the headings.
  explicit RunTable(const std::vector<std::string>& names);
  void add(std::vector<std::string> names, const RunReport& report);
  std::string text() const { return table_.text(); }

 private:
  Table table_;
};

/// A paragraph on what 99 % of the steps take at most, in the quickest and the slowest of the runs; empty when no run
/// was long enough to tell. Precondition: there is a report.
std::string step_time_text(std::span<const RunReport> reports);

/// Explains "-" for metrics of settled contact in runs that touched; empty when there is none.
std::string unsettled_text(std::span<const RunReport> reports);

/// The tables of thesis D.4 for a report with targets: mean and standard error over subjects, a line for each place.
/// Empty for other reports.
std::string targets_text(const RunReport& report);

/// A table of the rendered force against the reference, for the reports that have one; empty without any.
std::string fidelity_text(std::span<const RunReport> reports);

/// The warnings of runs that were made side by side. Warnings that differ only in numbers appear once, with the numbers
/// of the first run and the names of the other algorithms.
std::vector<std::string> run_warnings(std::span<const RunReport> reports);

/// A table of step latencies [us] and missed deadlines: an empty one, and the row of a run.
Table latency_table();
std::vector<std::string> latency_cells(const std::string& name, const StepLatency& latency);

/// The columns of comparison.csv: algorithm, outcome, steps, and the metrics that separate algorithms.
std::vector<Column> comparison_columns();

/// Writes comparison.csv: a line for each run of one scene, without times, so that equal comparisons give equal bytes.
/// Several seeds, which follow each other within an algorithm, get a column in front. Throws IoError.
void write_comparison(const std::filesystem::path& file, std::span<const RunReport> reports, std::size_t seeds = 1);

/// The metrics of the printed table of runs, each a number.
std::vector<std::string> compared_metrics();

/// A number with the digits that its error leaves it: one where the error is larger, six where it is 0, four where it
/// is not known.
std::string number_text(double value, const std::optional<double>& error);
/// The same with the error behind: "1.234 +- 0.005".
std::string with_error_text(double value, const std::optional<double>& error);

}  // namespace hapbench
