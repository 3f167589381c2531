#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "results/summary/outcome_names.hpp"

namespace hapbench {
namespace {

/// As narrow as it gets: "1440" in place of "1.44e+03".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()) + 0.0, digits);  // no "-0"
}

}  // namespace

std::vector<Table::Column> run_columns() {
  return {{"outcome", false}, {"cont\n%"},   {"land.\nmax N"}, {"mean\nN"},      {"step\np99 N"},
          {">30Hz\nrms N"},   {"rev.\n1/s"}, {"depth\nmm"},    {"ratio", false}, {"us/\nstep"}};
}

std::vector<std::string> run_cells(const RunReport& report) {
  const Metrics& m = report.summary.metrics;
  const ContactForces& contact = m.contact;
  const auto rows = static_cast<double>(report.summary.result.rows);
  return {std::string(outcome_name(report.summary.result.outcome)),
          cell(100.0 * static_cast<double>(m.steps_in_contact) / rows),
          cell(contact.landing_max()),
          cell(contact.mean()),
          cell(contact.step_p99()),
          cell(contact.rms_above_cutoff()),
          cell(contact.reversals_per_second()),
          cell(1e3 * m.depth_max),
          m.ratio ? fmt::format("{}..{}", cell(m.ratio->min, 2), cell(m.ratio->max, 2)) : "-",
          cell(1e6 * report.timing.loop / rows)};
}

std::string reduction_text(std::span<const RunReport> reports) {
  const RunReport* worst = nullptr;
  const auto step_max = [](const RunReport& report) { return report.summary.metrics.reduction->step_max(); };
  std::vector<std::string> others;
  for (const RunReport& report : reports) {
    const auto& jumps = report.summary.metrics.reduction;
    if (!jumps || !jumps->stand_out()) continue;
    const bool is_worst = worst == nullptr || step_max(report) > step_max(*worst);
    if (is_worst && worst != nullptr) others.push_back(worst->summary.algorithm);
    if (!is_worst) others.push_back(report.summary.algorithm);
    if (is_worst) worst = &report;
  }
  if (worst == nullptr) return "";
  const ReductionJumps& jumps = *worst->summary.metrics.reduction;
  return fmt::format(
      "warning: reduction: kept points change in {} of {} steps, force steps up to {} N there and {} N elsewhere ({}{}{}); "
      "rendering.reduction=null keeps them all\n",
      jumps.changes, worst->summary.result.rows, cell(jumps.step_max(), 2), cell(jumps.step_max_elsewhere(), 2),
      worst->summary.algorithm, others.empty() ? "" : "; also ", fmt::join(others, ", "));
}

std::vector<std::string> run_warnings(std::span<const RunReport> reports) {
  std::vector<std::pair<std::string, std::string>> algorithms_by_text;  // in the order of their first appearance
  for (const RunReport& report : reports) {
    for (const std::string& warning : report.summary.warnings) {
      const std::string text = report.summary.name + ": " + warning;
      const auto known = std::find_if(algorithms_by_text.begin(), algorithms_by_text.end(),
                                      [&text](const auto& entry) { return entry.first == text; });
      if (known == algorithms_by_text.end()) {
        algorithms_by_text.emplace_back(text, report.summary.algorithm);
      } else {
        known->second += ", " + report.summary.algorithm;
      }
    }
  }
  std::vector<std::string> warnings;
  for (const auto& [text, algorithms] : algorithms_by_text)
    warnings.push_back(reports.size() == 1 ? text : fmt::format("{} ({})", text, algorithms));
  return warnings;
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
