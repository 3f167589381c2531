#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>

#include <limits>

#include "results/summary/outcome_names.hpp"

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

std::string friction_text(std::span<const RunReport> reports) {
  std::string names;
  std::string_view last;  // several seeds of an algorithm come one after the other; the first tells
  double limit = 0.0;
  for (const RunReport& report : reports) {
    const auto& friction = report.summary.metrics.explicit_friction;
    if (!friction || !friction->first_step || report.summary.algorithm == last) continue;
    last = report.summary.algorithm;
    limit = friction->limit;
    names += fmt::format("{}{} (step {})", names.empty() ? "" : ", ", report.summary.algorithm, *friction->first_step);
  }
  if (names.empty()) return "";
  return fmt::format(
      "warning: beyond {} N of spring force the explicit step of friction is unstable; what follows is the "
      "integrator's doing, not the law's: {}\n",
      significant(limit, 3), names);
}

std::string targets_text(const RunReport& report) {
  if (!report.summary.targets) return "";
  const auto cell = [](const SubjectMean& m, int digits) {
    return m.subjects == 0 ? "-"
                           : fmt::format("{} +- {}", significant(m.mean, digits), significant(m.standard_error, 2));
  };
  Table table({{"place"}, {"success rate"}, {"completion s"}, {"model force N"}, {"speed mm/s"}});
  for (const PlaceMetrics& place : *report.summary.targets) {
    SubjectMean speed = place.speed;
    speed.mean *= 1e3;
    speed.standard_error *= 1e3;
    table.add({std::to_string(place.place), cell(place.success_rate, 3), cell(place.completion_time, 3),
               cell(place.model_force, 3), cell(speed, 3)});
  }
  return fmt::format("\n{}: targets, mean +- standard error over subjects\n\n{}", report.summary.name, table.text());
}

}  // namespace hapbench
