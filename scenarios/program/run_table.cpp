#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "results/summary/outcome_names.hpp"

namespace hapbench {
namespace {

/// As narrow as it gets: "1440" in place of "1.44e+03".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()) + 0.0, digits);  // no "-0"
}

/// Equal for warnings that say the same of different runs.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return std::string_view("0123456789.+-e").find(c) != std::string_view::npos; });
  return text;
}

/// Runs of one scenario are told apart by their algorithms.
std::string distinct_name(const RunReport& report, std::span<const RunReport> reports) {
  const bool one_scenario = reports.front().summary.name == reports.back().summary.name;
  return one_scenario ? report.summary.algorithm : report.summary.name;
}

}  // namespace

std::vector<Table::Column> run_columns() {
  std::vector<Table::Column> columns;
  for (const RunHeading& heading : kRunHeadings) columns.push_back({heading.title, heading.number});
  return columns;
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
          report.timing.step_p50 ? cell(1e6 * *report.timing.step_p50, 2) : "-"};
}

std::vector<std::string> run_warnings(std::span<const RunReport> reports) {
  struct Warning {
    std::string kind, text;
    std::vector<std::string> algorithms;
  };
  std::vector<Warning> warnings;  // in the order of their first appearance
  for (const RunReport& report : reports) {
    for (const std::string& text : report.summary.warnings) {
      const std::string kind = without_numbers(text);
      auto known = std::find_if(warnings.begin(), warnings.end(), [&](const Warning& w) { return w.kind == kind; });
      if (known == warnings.end()) known = warnings.insert(known, {kind, report.summary.name + ": " + text, {}});
      auto& algorithms = known->algorithms;
      // Several seeds of an algorithm come one after the other; the first tells.
      if (algorithms.empty() || algorithms.back() != report.summary.algorithm)
        algorithms.push_back(report.summary.algorithm);
    }
  }
  std::vector<std::string> texts;
  for (const auto& [kind, text, algorithms] : warnings) {
    if (reports.size() == 1) {
      texts.push_back(text);
    } else {
      const auto others = std::span(algorithms).subspan(1);
      texts.push_back(fmt::format("{} ({}{}{})", text, algorithms[0], others.empty() ? "" : "; likewise ",
                                  fmt::join(others, ", ")));
    }
  }
  return texts;
}

std::string step_time_text(std::span<const RunReport> reports) {
  const auto p99_or = [](double none) {
    return [none](const RunReport& report) { return report.timing.step_p99.value_or(none); };
  };
  const RunReport& quickest = *std::ranges::min_element(reports, {}, p99_or(std::numeric_limits<double>::infinity()));
  const RunReport& slowest = *std::ranges::max_element(reports, {}, p99_or(0.0));
  if (!slowest.timing.step_p99) return "";
  const auto us = [](const RunReport& report) { return cell(1e6 * *report.timing.step_p99, 2); };
  const std::string quick = distinct_name(quickest, reports), slow = distinct_name(slowest, reports);
  if (quick == slow) {
    const std::string whose = reports.size() == 1 ? "" : fmt::format(" ({})", slow);
    return fmt::format("\n99 % of the steps take at most {} us{}\n", us(slowest), whose);
  }
  return fmt::format("\n99 % of the steps take at most {} us ({}) to {} us ({})\n", us(quickest), quick, us(slowest),
                     slow);
}

std::string unsettled_text(std::span<const RunReport> reports) {
  std::vector<std::string> names;
  bool landed = false;
  for (const RunReport& report : reports) {
    const Metrics& m = report.summary.metrics;
    if (m.steps_in_contact == 0 || m.contact.mean()) continue;
    names.push_back(distinct_name(report, reports));
    landed = landed || m.contact.landing_max();
  }
  if (names.empty()) return "";
  // Without landings all contact counts already.
  const std::string_view advice = landed ? "; --set metrics.from_s=0 takes all contact" : "";
  return fmt::format(
      "\n{}", wrapped(fmt::format("\"-\": under 1/30 s of settled contact ({}){}", fmt::join(names, ", "), advice), 0));
}

std::string targets_text(const RunReport& report) {
  if (report.summary.section("targets") == nullptr) return "";
  const auto cell = [](const SubjectMean& m, int digits) {
    return m.subjects == 0 ? "-"
                           : fmt::format("{} +- {}", significant(m.mean, digits), significant(m.standard_error, 2));
  };
  Table table({{"place"}, {"success rate"}, {"completion s"}, {"model force N"}, {"speed mm/s"}});
  for (const PlaceMetrics& place : place_metrics(report.targets)) {
    SubjectMean speed = place.speed;
    speed.mean *= 1e3;
    speed.standard_error *= 1e3;
    table.add({std::to_string(place.place), cell(place.success_rate, 3), cell(place.completion_time, 3),
               cell(place.model_force, 3), cell(speed, 3)});
  }
  return fmt::format("\n{}: targets, mean +- standard error over subjects\n\n{}", report.summary.name, table.text());
}

}  // namespace hapbench
