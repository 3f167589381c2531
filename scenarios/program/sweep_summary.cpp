#include "scenarios/program/sweep_summary.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/sweep_grid_text.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

/// Longer tables are not printed; other programs show them better.
constexpr std::size_t kMostShown = 100;

/// A metric for people, in another unit.
std::string shown(const std::optional<double>& value, double factor) {
  return value ? significant(factor * *value, 3) : "-";
}

/// The runs of a single axis.
std::string runs_text(const SweepPlan& plan, const std::vector<SweepRow>& rows) {
  struct Shown {
    const char* column;
    const char* title;
    double factor;
  };
  // As the tables of run and compare have them (run_table.cpp).
  static constexpr Shown kMetrics[] = {{"contact_share", "con\n%", 100.0},
                                       {"landing_force_max_N", "land.\nmax N", 1.0},
                                       {"force_mean_in_contact_N", "mean\nN", 1.0},
                                       {"force_step_p99_N", "step\np99 N", 1.0},
                                       {"force_rms_above_30Hz_N", ">30Hz\nrms N", 1.0},
                                       {"force_reversals_per_s", "rev.\n1/s", 1.0},
                                       {"depth_max_m", "depth\nmm", 1e3}};
  std::vector<Table::Column> columns = {{plan.points.axes()[0].path}, {"outcome", false}};
  for (const Shown& metric : kMetrics) columns.push_back({metric.title});
  Table table(columns);
  for (const SweepRow& row : rows) {
    std::vector<std::string> cells = {plan.points.value(row.run, 0), row.outcome};
    for (const Shown& metric : kMetrics) cells.push_back(shown(row.number(plan, metric.column), metric.factor));
    table.add(std::move(cells));
  }
  return table.text();
}

}  // namespace

std::string chosen_metric(const SweepPlan& plan, const std::string& asked_for) {
  if (!asked_for.empty()) {
    require_valid_name("--metric: got", asked_for, plan.metrics);
    return asked_for;
  }
  const auto has = [&plan](std::string_view name) {
    return std::find(plan.metrics.begin(), plan.metrics.end(), name) != plan.metrics.end();
  };
  return std::string(*std::find_if(std::begin(kDefaultMetrics), std::end(kDefaultMetrics) - 1, has));
}

std::string summary_text(const SweepPlan& plan, const SweepReport& report, const std::string& metric) {
  std::string text = grid_text(plan, report.rows, metric);
  if (plan.points.axes().size() == 1 && report.counts.runs <= kMostShown) text = runs_text(plan, report.rows) + "\n";
  Table table({{"outcome", false}, {"runs"}, {"as expected"}});
  for (const auto& [outcome, count] : report.counts.outcomes) {
    table.add({outcome, std::to_string(count.runs), std::to_string(count.expected)});
  }
  text += table.text();
  if (report.resumed > 0) text += fmt::format("\n{} of the runs were done before\n", report.resumed);
  return text + fmt::format("\nresults in {}\n", report.table.string());
}

Json summary_json(const SweepPlan& plan, const SweepReport& report) {
  const SweepCounts& counts = report.counts;
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : counts.outcomes) outcomes[outcome] = count.runs;
  Json json = {{"definition", plan.definition},   {"runs", counts.runs},     {"outcomes", std::move(outcomes)},
               {"unexpected", counts.unexpected}, {"failed", counts.failed}, {"file", report.table.string()}};
  if (counts.runs <= SweepReport::kMostRows) {
    json["rows"] = Json::array();
    for (const SweepRow& row : report.rows) json["rows"].push_back(row_json(plan, row));
  }
  return json;
}

}  // namespace hapbench
