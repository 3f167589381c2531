#include "scenarios/program/run_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "results/io/atomic_file.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/result_tables.hpp"

namespace hapbench {
namespace {

/// A number of few characters: "1440" in place of "1.44e+03", and never "-0".
std::string cell(std::optional<double> value, int digits = 3) {
  if (value && digits < 3) value = std::stod(significant(*value, digits));
  if (value && std::abs(*value) >= 100.0 && std::abs(*value) < 1e6) return fmt::format("{:.0f}", *value);
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()) + 0.0, digits);
}

/// The metric of that name with the digits that its tolerance leaves it; `factor`: to the unit that is shown.
std::string metric_cell(const MetricList& metrics, std::string_view name, double factor) {
  const Metric* metric = find_metric(metrics, name);
  const auto value = metric == nullptr ? std::nullopt : number_of(metric->value);
  return value ? cell(factor * *value, deserved_digits(*value, metric->tolerance(), 3)) : "-";
}

/// A time in microseconds of at most four characters, so that tables are as wide on a slow machine as on a fast one:
/// "0.94", "1440", "23ms", "1.2s".
std::string short_time(double seconds) {
  const double us = 1e6 * seconds;
  if (us < 0.995) return fmt::format("{:.2f}", us);
  if (us < 9999.5) return cell(us, 2);
  if (us < 99.5e3) return fmt::format("{:.0f}ms", 1e-3 * us);
  return seconds < 9.95 ? fmt::format("{:.1f}s", seconds) : fmt::format("{:.0f}s", std::min(seconds, 999.0));
}

/// The same time with its unit, for a sentence.
std::string time_text(double seconds) {
  const std::string text = short_time(seconds);
  return text.ends_with('s') ? text : text + " us";
}

/// A warning without its numbers: equal for warnings that say the same of different runs.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return std::string_view("0123456789.+-e").find(c) != std::string_view::npos; });
  return text;
}

/// Runs of one scenario are told apart by their algorithms.
std::string distinct_name(const RunReport& report, std::span<const RunReport> reports) {
  const bool one_scenario = reports.front().summary.name == reports.back().summary.name;
  return one_scenario ? report.summary.algorithm : report.summary.name;
}

std::vector<Table::Column> columns_behind(const std::vector<std::string>& names) {
  std::vector<Table::Column> columns;
  for (const std::string& name : names) columns.push_back({name, false});
  for (const RunHeading& heading : kRunHeadings) columns.push_back({heading.title, heading.number});
  return columns;
}

std::string cell_below(const RunHeading& heading, const RunReport& report, const MetricList& metrics) {
  const std::string_view first = heading.shows[0];
  if (first == "outcome") return std::string(outcome_name(report.summary.result.outcome));
  if (first == "step_p50_s") return report.timing.step_p50 ? short_time(*report.timing.step_p50) : "-";
  if (heading.shows[1] == nullptr) return metric_cell(metrics, first, heading.factor);
  const auto value = number_of(value_of(metrics, first));
  const auto other = number_of(value_of(metrics, heading.shows[1]));
  return value && other ? fmt::format("{}..{}", cell(value, 2), cell(other, 2)) : "-";
}

/// The names of all algorithms fit into kTableWidth with it.
constexpr std::size_t kNarrowGap = 1;

}  // namespace

RunTable::RunTable(const std::vector<std::string>& names) : table_(columns_behind(names), kNarrowGap) {}

void RunTable::add(std::vector<std::string> names, const RunReport& report) {
  const MetricList metrics = metric_list(report.summary.metrics);
  for (const RunHeading& heading : kRunHeadings) names.push_back(cell_below(heading, report, metrics));
  table_.add(std::move(names));
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
      // The seeds of an algorithm follow each other.
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
  const std::string quick = distinct_name(quickest, reports), slow = distinct_name(slowest, reports);
  const auto of = [](const RunReport& report, const std::string& name) {
    return fmt::format("{} ({})", time_text(*report.timing.step_p99), name);
  };
  std::string text = "99 % of the steps take at most ";
  if (reports.size() == 1) {
    text += time_text(*slowest.timing.step_p99);
  } else {
    text += quick == slow ? of(slowest, slow) : of(quickest, quick) + " to " + of(slowest, slow);
  }
  return "\n" + wrapped(text, 0);
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
  // In runs without landings all contact counts already.
  const std::string_view advice = landed ? "; --set metrics.from_s=0 takes all contact" : "";
  return fmt::format(
      "\n{}", wrapped(fmt::format("\"-\": under 1/30 s of settled contact ({}){}", fmt::join(names, ", "), advice), 0));
}

const std::vector<Table::Column> kTargetHeadings = {{"place", true, "number of the target, from 0"},
                                                    {"success rate", true, "targets.0.success_rate.mean"},
                                                    {"completion s", true, "targets.0.completion_time_s.mean"},
                                                    {"model force N", true, "targets.0.model_force_N.mean"},
                                                    {"speed mm/s", true, "targets.0.speed_m_per_s.mean"}};

std::vector<Table::Column> latency_headings() {
  std::vector<Table::Column> columns = {{"step latency", false, "of run --latency: the scene whose steps were timed"},
                                        {"steps"}};
  for (const char* part : {"p50", "p95", "p99", "p99.9"})
    columns.push_back({fmt::format("{} us", part), true,
                       fmt::format("what {} % of the steps take at most, each by itself [us]", part + 1)});
  columns.push_back({"max us", true, "the longest step [us]"});
  for (const double deadline : kStepDeadlines)
    columns.push_back({fmt::format("> {:.3f} ms", 1e3 * deadline), true, "number of steps that took longer"});
  columns.push_back({"clock us", true, "what reading the clock takes, which is within each step's time [us]"});
  return columns;
}

std::string targets_text(const RunReport& report) {
  if (report.summary.section("targets") == nullptr) return "";
  const auto cell = [](const SubjectMean& m, int digits) {
    return m.subjects == 0 ? "-"
                           : fmt::format("{} +- {}", deserved(m.mean, 0.1 * m.standard_error, digits),
                                         significant(m.standard_error, 2));
  };
  Table table(kTargetHeadings);
  for (const PlaceMetrics& place : place_metrics(report.targets)) {
    SubjectMean speed = place.speed;
    speed.mean *= 1e3;
    speed.standard_error *= 1e3;
    table.add({std::to_string(place.place), cell(place.success_rate, 3), cell(place.completion_time, 3),
               cell(place.model_force, 3), cell(speed, 3)});
  }
  return fmt::format("\n{}: targets, mean +- standard error over subjects\n\n{}", report.summary.name, table.text());
}

Table latency_table() {
  return Table(latency_headings());
}

std::vector<std::string> latency_cells(const std::string& name, const StepLatency& latency) {
  std::vector<std::string> cells = {name, std::to_string(latency.steps)};
  const auto add_time = [&](std::uint64_t ns) {
    cells.push_back(latency.steps > 0 ? fmt::format("{:.3f}", static_cast<double>(ns) / 1e3) : "-");
  };
  for (const std::uint64_t ns : {latency.p50, latency.p95, latency.p99, latency.p99_9, latency.max}) add_time(ns);
  for (const std::uint64_t misses : latency.misses) cells.push_back(std::to_string(misses));
  add_time(latency.overhead);
  return cells;
}

std::string fidelity_text(std::span<const RunReport> reports) {
  const bool one_scenario = reports.front().summary.name == reports.back().summary.name;
  std::vector<Table::Column> columns = {{one_scenario ? "algorithm" : "scenario", false}};
  for (const RunHeading& heading : kFidelityHeadings) columns.push_back({heading.title});
  Table table(columns);
  bool any = false;
  for (const RunReport& report : reports) {
    if (report.summary.section("fidelity") == nullptr) continue;
    any = true;
    const MetricList metrics = metric_list(report.summary);
    std::vector<std::string> cells = {distinct_name(report, reports)};
    for (const RunHeading& heading : kFidelityHeadings)
      cells.push_back(metric_cell(metrics, heading.shows[0], heading.factor));
    table.add(std::move(cells));
  }
  return any ? fmt::format("\nrendered force against the reference, measured or ideal\n\n{}", table.text()) : "";
}

std::vector<Table::Column> run_headings() {
  std::vector<Table::Column> headings = joined_headings({kTargetHeadings, latency_headings()});
  const auto add = [&headings](const RunHeading& heading) {
    for (const char* shown : heading.shows)
      if (shown != nullptr) headings.push_back({heading.title, heading.number, shown});
  };
  for (const RunHeading& heading : kRunHeadings) add(heading);
  for (const RunHeading& heading : kFidelityHeadings) add(heading);
  return headings;
}

namespace {

/// Programs may read these by their place: append new ones.
constexpr const char* kComparedMetrics[] = {"force_max_N",
                                            "velocity_total_variation_m_per_s",
                                            "force_reversals",
                                            "vibration_power_above_30Hz_m2_per_s2",
                                            "depth_max_m",
                                            "ratio_min",
                                            "ratio_max",
                                            "steps_in_contact",
                                            "contact_share",
                                            "landings",
                                            "landing_force_max_N",
                                            "landing_force_step_max_N",
                                            "settled_s",
                                            "force_mean_in_contact_N",
                                            "settled_force_max_N",
                                            "force_step_p99_N",
                                            "settled_force_step_max_N",
                                            "force_rms_above_30Hz_N",
                                            "force_reversals_per_s",
                                            "reduction_changes",
                                            "reduction_force_step_max_N",
                                            "inside_max_m",
                                            "inside_settled_m",
                                            "centre_inside_share",
                                            "vibration_last_quarter_m_per_s",
                                            "fidelity.force_error_relative",
                                            "fidelity.force_direction_error_rad",
                                            "fidelity.force_artefact_share"};

}  // namespace

std::vector<Column> comparison_columns() {
  std::vector<Column> columns = {
      {"algorithm", "", "force algorithm"}, {"outcome", "", "how the run ended"}, {"steps", "1", "rows of the run"}};
  const MetricList metrics = metrics_without_values();
  for (const char* name : kComparedMetrics) {
    const Metric& metric = *find_metric(metrics, name);
    columns.push_back({name, metric.unit, metric.meaning});
  }
  return columns;
}

void write_comparison(const std::filesystem::path& file, std::span<const RunReport> reports, std::size_t seeds) {
  std::string text = (seeds > 1 ? "seed," : "") + header_of(comparison_columns()) + "\n";
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const RunSummary& run = reports[i].summary;
    if (seeds > 1) text += fmt::format("{},", i % seeds);
    text += fmt::format("{},{},{}", run.algorithm, outcome_name(run.result.outcome), run.result.rows);
    const MetricList metrics = metric_list(run);
    for (const char* name : kComparedMetrics) text += "," + cell_text(value_of(metrics, name));
    text += "\n";
  }
  write_file_atomically(file, text);
}

std::vector<std::string> compared_metrics() {
  std::vector<std::string> metrics;
  for (const RunHeading& heading : kRunHeadings)
    if (heading.factor != 0.0) metrics.emplace_back(heading.shows[0]);
  return metrics;
}

std::string number_text(double value, const std::optional<double>& error) {
  if (error && *error == 0.0) return significant(value, 6);
  return error && *error >= std::abs(value) ? significant(value, 1) : deserved(value, error);
}

std::string with_error_text(double value, const std::optional<double>& error) {
  return fmt::format("{} +- {}", number_text(value, error), error ? significant(*error, 1) : "?");
}

}  // namespace hapbench
