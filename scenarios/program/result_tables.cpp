#include "scenarios/program/result_tables.hpp"

#include <fmt/format.h>

#include "device_model/theory/stiffness_limits.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/batch/ranking_check.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {
namespace {

/// The columns that every map fills.
constexpr Column kEdgeColumns[] = {
    {"algorithm", "", "force algorithm"},
    {"{x}", "by name", "x of the map"},
    {"analytic_{y}", "by name",
     "the edge in y in closed form, or by the eigenvalues of a step or of the loop; empty without theory"},
    {"simulation_{y}", "by name", "the edge in y by bisection on runs, to 0.1 %"},
    {"relative_difference", "1", "simulation / analytic - 1"},
    {"no_theory", "", "why there is no analytic limit"},
    {"integrator", "", "integrator"},
    {"worst_hand_{y}", "by name",
     "least edge over passive hands of 100 to 1000 N/m and 0.1 to 0.5 kg, and none, by eigenvalues; of maps of K with an "
     "impedance device"}};

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

std::string map_header(std::span<const Column> columns, const std::string& x, const std::string& y) {
  return fmt::format(fmt::runtime(header_of(columns)), fmt::arg("x", x), fmt::arg("y", y));
}

std::span<const Column> stability_boundary_columns() {
  static const std::vector<std::string> kTexts = [] {
    std::vector<std::string> texts;
    for (const StiffnessLimit& limit : stiffness_limits()) {
      texts.push_back(fmt::format("{}_{{y}}", limit.name));
      texts.push_back(fmt::format("the y at which {}; for {} ({})", limit.formula, limit.applies, limit.source));
    }
    return texts;
  }();
  static const std::vector<Column> kColumns = [] {
    std::vector<Column> columns = all(kEdgeColumns);
    for (std::size_t i = 0; i < kTexts.size(); i += 2)
      columns.push_back({kTexts[i].c_str(), "by name", kTexts[i + 1].c_str()});
    columns.push_back(
        {"tangent_{y}", "by name",
         "with dry friction: the edge along the wall, of the bristle's K_t and B_t; analytic is across it"});
    columns.push_back({"overrides", "", "of time step, device and hand, as --set gave them; empty without"});
    return columns;
  }();
  return kColumns;
}

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables) {
  std::vector<Table::Column> all;
  for (const std::vector<Table::Column>& table : tables) all.insert(all.end(), table.begin(), table.end());
  return all;
}

std::vector<Table::Column> printed_headings() {
  return joined_headings({run_headings(), league_headings(), limit_headings(false), limit_headings(true),
                          converge_headings(), device_headings(), stability_headings(), diff_headings(),
                          sweep_headings(), tune_headings(), claim_headings()});
}

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  for (const ResultTable& table : record_tables()) tables.push_back({table.file, table.holds, all(table.columns)});
  tables.push_back({kTargetTable.file, kTargetTable.holds, all(kTargetTable.columns)});
  tables.push_back({"comparison.csv", "of compare: one line per algorithm", comparison_columns()});
  tables.push_back({"league.csv",
                    "of compare with several scenarios or seeds: one line per scenario, algorithm and metric",
                    league_columns()});
  tables.push_back({"ranking.csv",
                    "of compare --check or --html: one line per scenario, halved spacing or step, metric and algorithm",
                    ranking_columns()});
  tables.push_back(
      {"device_limits.csv", "of compare --devices: one line per device, scene and algorithm", device_limit_columns()});
  tables.push_back({"device_runs.csv", "of compare --devices: one line per run", device_run_columns()});
  tables.push_back({"limit.csv", "of limit: one line per algorithm", limit_columns()});
  tables.push_back({"limit_runs.csv", "of limit: one line per run", all(limit_run_columns())});
  tables.push_back({"converge.csv", "of converge: one line per metric", converge_columns()});
  tables.push_back({"converge_levels.csv", "of converge: one line per metric and level", converge_level_columns()});
  tables.push_back({"tune.csv", "of tune: one line per algorithm", tune_columns()});
  tables.push_back(
      {"tune_trials.csv", "of tune: one line per algorithm, setting and K that was tried", tune_trial_columns()});
  tables.push_back({"sweep.csv", "of sweep: one line per run", sweep_columns()});
  tables.push_back({"limits.csv", "of stability SCENARIO: one line per limit", stability_limit_columns()});
  tables.push_back({"root_locus.csv", "of stability SCENARIO: eigenvalues of a step as the case's number grows",
                    root_locus_columns()});
  tables.push_back({"stability_map_NAME.csv", "of stability --map: one line per run", all(kStabilityMapColumns)});
  tables.push_back({"stability_boundary_NAME.csv", "of stability --map: one line per x of the map",
                    all(stability_boundary_columns())});
  tables.push_back({"stability_stress.csv", "of stability --stress: one line per algorithm", stress_columns()});
  tables.push_back({"shell.csv", "of shell: one line per point of the environment", all(kShellColumns)});
  return tables;
}

}  // namespace hapbench
