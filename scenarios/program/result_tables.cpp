#include "scenarios/program/result_tables.hpp"

#include <fmt/format.h>

#include "results/record/recorder.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/limit_answers.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {
namespace {

/// The columns of all studies; a study writes those that it computes.
constexpr Column kPrecisionColumns[] = {
    {"setting", "", "what the row is of"},
    {"outcome", "", "how its run ended"},
    {"seconds_per_step", "s", "of precision_*_timing.csv: least time of a step over the repetitions"},
    {"seconds_per_call", "s", "of precision_*_timing.csv: least time of a call over the repetitions"},
    {"step_s", "s", "time step"},
    {"error_final_m", "m", "distance from the reference at the end"},
    {"error_rms_m", "m", "root mean square distance from the reference"},
    {"error_max_m", "m", "largest distance from the reference"},
    {"error_final_N", "N",
     "along a prescribed motion, of the rendered force: distance from the reference's at the end"},
    {"error_rms_N", "N", "root mean square of that distance"},
    {"error_max_N", "N", "largest such distance"},
    {"undamped_energy_gain_relative", "1", "energy at the end over that at the start, - 1, without damping"},
    {"undamped_energy_swing_relative", "1", "largest |energy - that at the start|, over the latter, without damping"},
    {"ideal_height_error_rms_m", "m", "root mean square of tip height - height of the ideal trajectory"},
    {"ideal_height_error_max_m", "m", "largest |tip height - height of the ideal trajectory|"},
    {"ideal_lateral_error_rms_m", "m", "root mean square of lateral place of the tip - that of the ideal trajectory"},
    {"interpenetration_max_m", "m", "largest true depth of the tool in the exact block"},
    {"force_step_max_N", "N", "largest force step ||f_k - f_(k-1)||"},
    {"tensor_error_rms", "1", "root mean square ||S - S of the exact optimum||, over the contact sets"},
    {"tensor_error_max", "1", "largest ||S - S of the exact optimum||"},
    {"ratio_error_max", "1", "largest |ratio of a contact - that of the exact optimum|"},
    {"spacing_m", "m", "grid of the density field that the shell is made of"},
    {"points", "1", "points of the shell"},
    {"shell_bytes", "byte", "memory of the shell's points and normals"},
    {"contacts_mean", "1", "mean number of contacts of a set"},
    {"kept_mean", "1", "mean number of contacts behind reduction or merging"},
    {"pushed_m", "m", "way of the tool from the start of the stroke"},
    {"depth_max_mean_m", "m", "mean of the largest penetration depth, over the poses"},
    {"rate_Hz", "Hz", "rate at which contacts are found"},
    {"force_rms_above_30Hz_N", "N", "as the metric of that name"},
    {"stiffness_max_N_per_m", "N/m",
     "largest K up to which the handle vibrates by at most 10 mm/s rms above 30 Hz, to 5 %; empty where none is found"},
    {"theory_N_per_m", "N/m", "largest stable K of one spring whose contact is found at that rate and held"},
    {"points_tested_mean", "1", "mean number of points that a query compares with the tool"},
    {"force_error_relative", "1", "rms difference to exact shaping of all contacts, over the rms force"},
    {"order_spread_relative", "1", "largest change of the force with the order of the points, over the rms force"},
    {"depth_error_max_m", "m", "largest difference of the force to exact shaping of all contacts, over K"},
    {"half_angle_rad", "rad", "half the wedge's angle"},
    {"ratio_min", "1", "smallest stiffness ratio u^T S u of a contact"},
    {"ratio_max", "1", "largest stiffness ratio u^T S u of a contact"},
    {"along_way_out", "1", "stiffness along the way out of the wedge, in units of K"},
    {"along_formula", "1", "the same in closed form"},
    {"across", "1", "stiffness across the wedge, in units of K"},
    {"across_formula", "1", "the same in closed form"},
    {"lambda_max", "1", "largest eigenvalue of S"},
    {"force_jump_max_N_per_um", "N/um",
     "largest change of the force over a step of the prescribed stroke, per micrometre"},
    {"force_change_max_N", "N", "the same change"},
    {"force_change_fine_max_N", "N",
     "the largest change over a tenth of the step: a tenth of it for a slope, as large for a jump"},
    {"force_jump_max_N", "N", "the jump J by which both are J + slope * step"},
    {"stiffness_over_step", "1", "force_jump_max_N_per_um in units of K"}};

constexpr Column kShellColumns[] = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

/// A sweep's table has the metrics that `expect` may bound between `steps` and `state_hash`.
std::vector<Column> sweep_columns() {
  static const MetricList kShownMetrics = metrics_without_values();
  std::vector<Column> columns = {{"index", "1", "number of the run, from 0; the varied fields follow, by their paths"},
                                 {"outcome", "", "how the run ended; \"error\" for one that could not be computed"},
                                 {"expected", "", "true when it ended as the scenario's expect says"},
                                 {"steps", "1", "rows of the run"}};
  for (const Metric& metric : kShownMetrics) columns.push_back({metric.name.c_str(), metric.unit, metric.meaning});
  static const std::vector<std::string> kTolerances = [] {
    std::vector<std::string> names;
    for (const Metric& metric : kShownMetrics) names.push_back(std::string(kToleranceOf) + metric.name);
    return names;
  }();
  for (std::size_t i = 0; i < kShownMetrics.size(); ++i) {
    if (kShownMetrics[i].bounded)
      columns.push_back({kTolerances[i].c_str(), kShownMetrics[i].unit, "by how much the metric may be wrong"});
  }
  columns.push_back(
      {"state_hash", "", "over the bits of position, velocity and force of every row: equal for equal runs"});
  return columns;
}

std::vector<Column> all(std::span<const Column> columns) {
  return {columns.begin(), columns.end()};
}

}  // namespace

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables) {
  std::vector<Table::Column> all;
  for (const std::vector<Table::Column>& table : tables) all.insert(all.end(), table.begin(), table.end());
  return all;
}

std::vector<Table::Column> printed_headings() {
  std::vector<std::vector<Table::Column>> all = {
      run_headings(),       league_headings(),          converge_headings(),
      stability_headings(), precision_headings("step"), precision_headings("call"),
      diff_headings(),      sweep_headings(),           tune_headings(),
      claim_headings()};
  for (const DescribedTable& table : result_tables()) all.push_back(table.headings);
  return joined_headings(all);
}

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    tables.push_back({file, holds, {columns.begin(), columns.end()}, {}});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, all(table.columns));
  add(kTargetTable.file, kTargetTable.holds, all(kTargetTable.columns));
  add("comparison.csv", "of compare: one line per algorithm", comparison_columns());
  add("league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric",
      league_columns());
  for (const DescribedTable& table : limit_tables()) tables.push_back(table);
  add("converge.csv", "of converge: one line per metric", converge_columns());
  add("converge_levels.csv", "of converge: one line per metric and level", converge_level_columns());
  add("tune.csv", "of tune: one line per algorithm", tune_columns());
  add("tune_trials.csv", "of tune: one line per algorithm, setting and K that was tried", tune_trial_columns());
  add("sweep.csv", "of sweep: one line per run", sweep_columns());
  add("limits.csv", "of stability SCENARIO: one line per limit", stability_limit_columns());
  add("root_locus.csv", "of stability SCENARIO: eigenvalues of a step as the case's number grows",
      root_locus_columns());
  tables.push_back(stress_table());
  add("precision_STUDY.csv", "of precision: one line per setting, with the columns of its study",
      all(kPrecisionColumns));
  add("shell.csv", "of shell: one line per point of the environment", all(kShellColumns));
  return tables;
}

}  // namespace hapbench
