#include "scenarios/commands/run_table.hpp"

#include <fmt/format.h>

#include <limits>

#include "results/outcome_names.hpp"

namespace hapbench {

std::vector<Table::Column> run_columns() {
  return {{"outcome", false},  {"steps"},        {"max force N"}, {"velocity TV m/s"}, {"reversals"},
          {"vibration m2/s2"}, {"max depth mm"}, {"ratio"},       {"us/step"}};
}

std::vector<std::string> run_cells(const RunReport& report) {
  const Metrics& m = report.summary.metrics;
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto rows = static_cast<double>(report.summary.result.rows);
  return {std::string(outcome_name(report.summary.result.outcome)),
          std::to_string(report.summary.result.rows),
          significant(m.force_max),
          significant(m.velocity_total_variation),
          std::to_string(m.force_reversals),
          significant(m.vibration_power.value_or(none), 3),
          significant(1e3 * m.depth_max),
          m.ratio ? fmt::format("{} ... {}", significant(m.ratio->min, 3), significant(m.ratio->max, 3)) : "-",
          significant(1e6 * report.timing.loop / rows, 3)};
}

}  // namespace hapbench
